#include "tests/reference/hmm/forward_filter.h"

#include <algorithm>

namespace tactus::internal {

ForwardFilter::ForwardFilter(const CompiledHmm& hmm)
    : hmm_(&hmm), storage_(5 * static_cast<size_t>(hmm.states())) {
  Reset();
}

Belief ForwardFilter::belief() {
  return {storage_.data(), storage_.data() + hmm_->states()};
}

Belief ForwardFilter::predicted() {
  return {storage_.data() + 2 * hmm_->states(),
          storage_.data() + 3 * hmm_->states()};
}

void ForwardFilter::Reset() {
  started_ = false;
  log_likelihood_ = CompensatedSum();
  const Belief b = belief();
  std::ranges::copy(hmm_->start(), b.probability);
  std::ranges::copy(hmm_->log_start(), b.log_probability);
}

// The distribution of the next frame's state. Before the first frame that is
// the start distribution.
void ForwardFilter::PredictNext() {
  if (started_) {
    Predict(*hmm_, belief(), predicted());
  } else {
    const int n = hmm_->states();
    std::copy_n(storage_.data(), 2 * n, storage_.data() + 2 * n);
    started_ = true;
  }
}

void ForwardFilter::Step(std::span<const double> observation) {
  const int n = hmm_->states();
  const std::span<double> log_density(storage_.data() + 4 * n, n);
  PredictNext();
  hmm_->emissions().LogDensity(observation, log_density);
  log_likelihood_.Add(Update(*hmm_, predicted(), log_density.data(), belief()));
}

void ForwardFilter::Skip(int missing) {
  const int n = hmm_->states();
  const std::span<double> flat(storage_.data() + 4 * n, n);
  std::ranges::fill(flat, 0.0);
  for (int k = 0; k < missing; ++k) {
    PredictNext();
    // A density of 1 everywhere; its log Z is only the rounding of the
    // transitions' row sums.
    Update(*hmm_, predicted(), flat.data(), belief());
  }
}

}  // namespace tactus::internal
