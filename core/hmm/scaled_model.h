// File: scaled_model.h
//
// HMMs of one shape packed side by side, for the kernels of scaled_kernels.h:
// in float to score streams, in double for training and for models that float
// cannot represent.
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

namespace tactus::internal {

// The properties that HMMs side by side have in common.
struct HmmShape {
  int states = 0;
  int dimensions = 0;
  bool full = false;  // off-diagonal covariances
  // Every transition from i to j with a probability above 0 has
  // first_jump <= j - i <= last_jump. The range contains 0.
  int first_jump = 0;
  int last_jump = 0;

  auto operator<=>(const HmmShape&) const = default;
};
HmmShape ShapeOf(const GaussianHmm& model);

// Factors for the observations, [D]. BalancedScale: powers of two that bring
// the models' deviations to about 1, so that float can represent their squares.
std::vector<double> UnitScale(int dimensions);
std::vector<double> BalancedScale(
    const std::vector<const GaussianHmm*>& models);

// False if scores in float would exceed the error bound of hmm_bank.h: the
// model is far from the scale, or nearly singular.
bool FitsFloat(const GaussianHmm& model, const std::vector<double>& scale);

template <typename T>
class ScaledModel {
 public:
  // models: at least one, valid, all of one shape; not referred to later.
  ScaledModel(const std::vector<const GaussianHmm*>& models,
              std::vector<double> scale);

  const HmmShape& shape() const { return shape_; }
  int components() const { return components_; }  // K
  // Cells from one state to the next: K or a little more.
  int stride() const { return stride_; }
  int period() const { return period_; }  // of patterns
  int cells() const { return shape_.states * stride_; }
  // Number of cells of a padded array, and of padding cells before the first.
  size_t padded() const { return padded_; }
  size_t front() const { return front_; }
  size_t Cell(int state, int component) const {
    return front_ + static_cast<size_t>(state) * stride_ + component;
  }
  const std::vector<double>& scale() const { return scale_; }

  // Fills `count` padded arrays with shares of zero (padding components: 1).
  void Clear(T* mantissa, T* exponent, size_t count) const;
  // The start distribution. [padded]
  const AlignedVector<T>& start_mantissa() const { return start_mantissa_; }
  const AlignedVector<T>& start_exponent() const { return start_exponent_; }

  // See scaled_kernels.h; shares are padded arrays.
  PredictStep<T> Prediction(bool best, Shares<T> from, Shares<T> to) const;
  void Predict(bool best, Shares<T> from, Shares<T> to) const;
  // Weighs with x as written by Observe. Patterns hold the same number for all
  // entries of a component. `to` is not `from`. Returns true if no component
  // fell by more than 2^20 bits (double: 2^40). Otherwise float has lost
  // digits. Double then weighs again, relative to each component's largest
  // density; this adds to `lowered` and does not change the order of the
  // states.
  bool Weigh(const T* x, T* lowered, T* largest_exponent, Shares<T> from,
             Shares<T> to) const;
  // Predicts and weighs one frame at once, without lowering. Returns false if a
  // component's largest exponent has reached 2^20 (double: 2^40) or fallen
  // below minus that; use Predict and Weigh for such a frame. largest_exponent
  // is not folded yet.
  bool Advance(bool best, const T* x, T* largest_exponent, Shares<T> from,
               Shares<T> to) const;
  // Combines the pattern entries of each component into one value.
  template <typename Combine>
  void Fold(T* pattern, Combine combine) const {
    FoldHalves<kPattern<T> / 2>(pattern, combine);
  }
  // Writes the scaled observation for all components to x: float [2 D], rounded
  // values and rounding errors; double [D x period].
  void Observe(std::span<const double> observation, T* x) const;
  size_t observed_size() const;  // entries of x

 private:
  // The sizes are template parameters because patterns are short.
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
  // Fills a padding component with the model before it.
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
  // Cholesky factor, diagonal first; in float, between the two, the row's
  // product with the rounding errors of the means. Then the logarithm of the
  // normalising constant. The factor is scaled so that squared distances are in
  // bits.
  AlignedVector<T> emissions_;
  AlignedVector<T> transitions_;  // [blocks][jumps][2][kBlock]
  AlignedVector<T> zeros_;        // [period]
  AlignedVector<T> start_mantissa_;
  AlignedVector<T> start_exponent_;
};

// p = mantissa 2^exponent with mantissa in [1, 2). For p = 0, the exponent is
// kNothing.
template <typename T>
void SplitProbability(double p, T& mantissa, T& exponent);

}  // namespace tactus::internal
