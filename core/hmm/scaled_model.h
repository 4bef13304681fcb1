// File: scaled_model.h
//
// HMMs of one shape packed side by side, for the kernels of scaled_kernels.h:
// in float for scoring streams, in double for training and for what float
// cannot hold.
//
//   const ScaledModel<float> packed({&model_a, &model_b}, UnitScale(3));
//   ScaledFilter<float> filter(packed, {}, Score::kForward);
//
// Thread-safe: immutable.
#pragma once

#include <compare>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/scaled_kernels.h"

namespace tactus {

// What HMMs share that lie side by side.
struct HmmShape {
  int states = 0;
  int dimensions = 0;
  bool full = false;  // off-diagonal covariances
  // Every transition from i to j > 0 has first_jump <= j - i <= last_jump; the
  // range holds 0.
  int first_jump = 0;
  int last_jump = 0;

  auto operator<=>(const HmmShape&) const = default;
};
HmmShape ShapeOf(const GaussianHmm& model);

// Factors on the observations, powers of two, [D]: those that bring the models'
// deviations to about 1, so that float can hold their squares.
std::vector<double> UnitScale(int dimensions);
std::vector<double> BalancedScale(
    const std::vector<const GaussianHmm*>& models);

// False if float would lose more of the model than the bound of hmm_bank.h
// grants: it is far from the scale, or nearly singular.
bool FitsFloat(const GaussianHmm& model, const std::vector<double>& scale);

template <typename T>
class ScaledModel {
 public:
  // models: at least one, valid, of one shape; not referred to later.
  ScaledModel(const std::vector<const GaussianHmm*>& models,
              std::vector<double> scale);

  const HmmShape& shape() const { return shape_; }
  int components() const { return components_; }  // K
  // Cells from one state to the next: K or a little more.
  int stride() const { return stride_; }
  int period() const { return period_; }  // of patterns
  int cells() const { return shape_.states * stride_; }
  // Cells of a padded array, and how many of them come before the first.
  size_t padded() const { return padded_; }
  size_t front() const { return front_; }
  size_t Cell(int state, int component) const {
    return front_ + static_cast<size_t>(state) * stride_ + component;
  }
  const std::vector<double>& scale() const { return scale_; }

  // Writes `count` padded arrays of shares that are nothing, of padding
  // components 1.
  void Clear(T* mantissa, T* exponent, size_t count) const;
  // The start distribution. [padded]
  const AlignedVector<T>& start_mantissa() const { return start_mantissa_; }
  const AlignedVector<T>& start_exponent() const { return start_exponent_; }

  // See scaled_kernels.h; shares are padded arrays.
  PredictStep<T> Prediction(bool best, Shares<T> from, Shares<T> to) const;
  void Predict(bool best, Shares<T> from, Shares<T> to) const;
  // Weighs with x, as Observe writes it. Patterns hold the same number for
  // all entries of a component. `to` is not `from`. True if no component fell
  // by more than 2^20 bits (double: 2^40), else float has lost digits; double
  // weighs again, relative to each component's largest density, which adds to
  // `lowered` and leaves the order of the states alone.
  bool Weigh(const T* x, T* lowered, T* largest_exponent, Shares<T> from,
             Shares<T> to) const;
  // Predicts and weighs at once, nothing lowered, for the frames between which
  // no digits are lost: false if a component's largest exponent has come to
  // 2^20 (double: 2^40) or fallen below minus that; Weigh is for those frames.
  // largest_exponent is not folded yet.
  bool Advance(bool best, const T* x, T* largest_exponent, Shares<T> from,
               Shares<T> to) const;
  // Makes one value of the pattern entries that belong to a component.
  template <typename Combine>
  void Fold(T* pattern, Combine combine) const {
    FoldHalves<kPattern<T> / 2>(pattern, combine);
  }
  // Scales an observation for all components into x: float [2 D], rounded and
  // what rounding left; double [D x period].
  void Observe(std::span<const double> observation, T* x) const;
  size_t observed_size() const;  // entries of x

 private:
  // Sizes known to the compiler, as patterns are short.
  template <int kHalf, typename Combine>
  void FoldHalves(T* pattern, Combine combine) const {
    if (stride_ > kHalf) return;
    for (int p = 0; p < kHalf; ++p) {
      pattern[p] = combine(pattern[p], pattern[p + kHalf]);
    }
    if constexpr (kHalf > 1) FoldHalves<kHalf / 2>(pattern, combine);
    for (int p = 0; p < kHalf; ++p) pattern[p + kHalf] = pattern[p];
  }
  WeighStep<T> Weighing(const T* x, const T* lowered, T* largest_exponent,
                        Shares<T> from, Shares<T> to) const;
  void WeighOnce(const T* x, const T* lowered, T* largest_exponent,
                 Shares<T> from, Shares<T> to) const;
  // The same model again.
  void CopyPrevious(int component);
  void PackEmissions(const GaussianHmm& model, int component);
  void PackTransitions(const GaussianHmm& model, int component);

  HmmShape shape_;
  std::vector<double> scale_;
  int components_;
  int stride_;
  int period_;
  size_t front_;
  size_t padded_;
  int rows_;  // of emission parameters
  // [blocks][rows][kBlock]: per dimension the mean and a row of the inverse
  // Cholesky factor, diagonal first, in float between them the row's product
  // with what rounding left of the means; then the logarithm of the normalising
  // constant. Squares of what the factor gives are in bits.
  AlignedVector<T> emissions_;
  AlignedVector<T> transitions_;  // [blocks][jumps][2][kBlock]
  AlignedVector<T> zeros_;        // [period]
  AlignedVector<T> start_mantissa_;
  AlignedVector<T> start_exponent_;
};

// p = mantissa 2^exponent with mantissa in [1, 2); a p of 0 is nothing.
template <typename T>
void SplitProbability(double p, T& mantissa, T& exponent);

}  // namespace tactus
