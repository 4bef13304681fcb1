// File: scaled_filter.h
//
// The incremental forward algorithm or Viterbi of all HMMs of a ScaledModel:
// one call per frame, constant memory. HmmBank puts categories together.
//
//   ScaledFilter<float> filter(packed, {}, Score::kForward);
//   filter.Step(observation);
//   filter.UpdateTotals();
//   filter.log_likelihood(component);
//
// Numerics: shares never underflow (scaled_kernels.h); the bits taken out of
// them are added up in double, exactly while below 2^53. What float rounds is
// below 1e-6 of the sum of the frames' absolute log-densities. A frame that is
// 2^20 bits from every state of a component is redone for it in double; in
// double a frame that is 2^40 bits away is weighed relative to its best state,
// so that outliers of any size leave the order of the states alone. An
// observation that is not finite, refused upstream, costs as much as the
// farthest one there is, -7e299 nats, and leaves the belief at the prediction.
//
// Not thread-safe: one per stream. Refers to the models, which must outlive it.
// Step, Skip, Reset and UpdateTotals allocate nothing.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/mixture.h"
#include "core/hmm/scaled_model.h"

namespace tactus {

template <typename T>
class ScaledFilter {
 public:
  // exact: for float, a double model of every component (K of them, each
  // alone); for double none.
  ScaledFilter(const ScaledModel<T>& model,
               std::span<const ScaledModel<double>> exact, Score score);

  // Forgets all frames.
  void Reset();
  // Takes in the next frame. observation: [D].
  void Step(std::span<const double> observation);
  // Passes over `missing` lost frames, as if summed over every value they
  // could have had.
  void Skip(int missing);

  // Makes what follows true of the frames so far.
  void UpdateTotals();
  // The component's likelihood or best path's is total * 2^exponent.
  double total(int component) const { return total_[component]; }
  double exponent(int component) const {
    return taken_out_[component] + static_cast<double>(largest_[component]);
  }
  // log p(o_1 .. o_t) or the best path's, nats.
  double log_likelihood(int component) const;

 private:
  template <typename>
  friend class ScaledFilter;

  Shares<T> Buffer(int index) {
    return {mantissa_.data() + index * model_->padded(),
            exponent_.data() + index * model_->padded()};
  }
  // Writes the distribution of the next frame's state to buffer `to`.
  void Predict(int to);
  // The frames that Advance leaves; takes out what the shares have gathered.
  void StepLowered(std::span<const double> observation);
  void FindLargestShares();
  // Of T float; `started`: as before the frame.
  void RedoExactly(int component, std::span<const double> observation,
                   bool started);
  const ScaledModel<T>* model_;
  std::span<const ScaledModel<double>> exact_;
  Score score_;
  bool started_ = false;
  // Three buffers of padded cells: 0 and 1 in turn this frame (now_) and the
  // frame before, 2 what that one predicts.
  AlignedVector<T> mantissa_, exponent_;
  int now_ = 0;
  AlignedVector<T> largest_, lowered_, total_;  // [period]
  std::vector<double> taken_out_;               // [period]
  AlignedVector<T> x_;  // the observation, as the model takes it
  std::unique_ptr<ScaledFilter<double>> redo_;
};

}  // namespace tactus
