#include "tests/reference/hmm/viterbi_filter.h"

#include <algorithm>
#include <limits>

namespace tactus::internal {

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

}  // namespace tactus::internal
