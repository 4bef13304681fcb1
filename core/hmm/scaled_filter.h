// File: scaled_filter.h
//
// The incremental forward algorithm, or Viterbi algorithm, of all HMMs of a
// ScaledModel: one call per frame, constant memory. HmmBank combines the
// results into classes.
//
//   ScaledFilter<float> filter(packed, {}, Score::kForward);
//   filter.Step(observation);
//   filter.UpdateTotals();
//   filter.log_likelihood(component);
//
// Numerics: the states' shares never underflow (scaled_kernels.h). Their common
// exponent is summed up in double, exactly up to 2^53 bits. The rounding error
// of float is below 1e-6 of the sum of the frames' absolute log-densities. If a
// frame is 2^20 bits from every state of a component, it is computed again in
// double for that component. In double, a frame that is 2^40 bits away is
// weighed relative to its best state, so that an outlier of any size does not
// change the order of the states. An observation that is not finite (the server
// refuses those) costs -7e299 nats, like the farthest finite one, and leaves
// the belief at the prediction.
//
// Not thread-safe: one filter per stream. Refers to the models, which must
// outlive it.
// Step, Skip, Reset and UpdateTotals allocate nothing.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/mixture.h"
#include "core/hmm/scaled_model.h"

namespace tactus::internal {

template <typename T>
class ScaledFilter {
 public:
  // exact: for float, K models in double with one component each; for double,
  // empty.
  ScaledFilter(const ScaledModel<T>& model,
               std::span<const ScaledModel<double>> exact, Score score);

  // Starts again before the first frame.
  void Reset();
  // Processes the next frame. observation: [D].
  void Step(std::span<const double> observation);
  // Passes over `missing` lost frames: sums over all values that they could
  // have had.
  void Skip(int missing);

  // Brings the three results below up to date with the frames so far.
  void UpdateTotals();
  // The likelihood of the component, or of its best path, is total *
  // 2^exponent.
  double total(int component) const { return total_[component]; }
  double exponent(int component) const {
    return taken_out_[component] + static_cast<double>(largest_[component]);
  }
  // log p(o_1 .. o_t), or that of the best path, in nats.
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
  // A frame that Advance refused. Lowers the exponents of the shares first.
  void StepLowered(std::span<const double> observation);
  void FindLargestShares();
  // Only for T = float. `started`: the value before this frame.
  void RedoExactly(int component, std::span<const double> observation,
                   bool started);
  const ScaledModel<T>* model_;
  std::span<const ScaledModel<double>> exact_;
  Score score_;
  bool started_ = false;
  // Three buffers of padded cells. 0 and 1 alternate between this frame (now_)
  // and the frame before; 2 holds the prediction.
  AlignedVector<T> mantissa_, exponent_;
  int now_ = 0;
  AlignedVector<T> largest_, lowered_, total_;  // [period]
  std::vector<double> taken_out_;               // [period]
  AlignedVector<T> x_;  // the observation, as the model takes it
  std::unique_ptr<ScaledFilter<double>> redo_;
};

}  // namespace tactus::internal
