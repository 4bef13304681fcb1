#include "core/hmm/forward.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {

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

ViterbiFilter::ViterbiFilter(const CompiledHmm& hmm)
    : hmm_(&hmm), storage_(3 * static_cast<size_t>(hmm.states())) {
  Reset();
}

void ViterbiFilter::Reset() {
  started_ = false;
  score_ = CompensatedSum();
  std::ranges::copy(hmm_->log_start(), storage_.data());
}

void ViterbiFilter::PredictNext() {
  const int n = hmm_->states();
  const double* path = storage_.data();
  double* predicted = storage_.data() + n;
  if (!started_) {
    std::copy_n(path, n, predicted);
    started_ = true;
    return;
  }
  for (int j = 0; j < n; ++j) {
    const CompiledHmm::Incoming incoming = hmm_->incoming(j);
    double best = -std::numeric_limits<double>::infinity();
    for (int i = incoming.first; i < incoming.last; ++i) {
      best = std::max(best,
                      path[i] + incoming.log_probability[i - incoming.first]);
    }
    predicted[j] = best;
  }
}

void ViterbiFilter::Step(std::span<const double> observation) {
  const int n = hmm_->states();
  double* path = storage_.data();
  const double* predicted = path + n;
  const std::span<double> log_density(path + 2 * n, n);
  PredictNext();
  hmm_->emissions().LogDensity(observation, log_density);
  const double shift = *std::ranges::max_element(log_density);
  for (int j = 0; j < n; ++j) path[j] = predicted[j] + (log_density[j] - shift);
  const double best = *std::max_element(path, path + n);
  for (int j = 0; j < n; ++j) path[j] -= best;
  score_.Add(shift);
  score_.Add(best);
}

void ViterbiFilter::Skip(int missing) {
  const int n = hmm_->states();
  double* path = storage_.data();
  for (int k = 0; k < missing; ++k) {
    PredictNext();
    const double best = *std::max_element(path + n, path + 2 * n);
    for (int j = 0; j < n; ++j) path[j] = path[n + j] - best;
    score_.Add(best);
  }
}

int ViterbiFilter::best_state() const {
  const auto end = storage_.begin() + hmm_->states();
  return static_cast<int>(std::max_element(storage_.begin(), end) -
                          storage_.begin());
}

}  // namespace tactus
