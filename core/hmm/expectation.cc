#include "core/hmm/expectation.h"

#include <algorithm>
#include <cmath>

#include "core/hmm/recursion.h"

namespace tactus {
namespace {

// Shares of a state below this add nothing to any sum.
constexpr double kNegligibleShare = 1e-30;

}  // namespace

void Expectation::Reset(const GaussianHmm& model) {
  states_ = model.states;
  dimensions_ = model.dimensions;
  full_ = model.covariance_type == CovarianceType::kFull;
  means_ = model.means;
  const size_t n = static_cast<size_t>(states_);
  const size_t d = static_cast<size_t>(dimensions_);
  log_likelihood_ = 0;
  starts_.assign(n, 0.0);
  transitions_.assign(n * n, 0.0);
  occupancy_.assign(n, 0.0);
  first_.assign(n * d, 0.0);
  second_.assign(n * d * d, 0.0);
  log_density_.resize(n);
  share_.resize(n);
  next_share_.resize(n);
  difference_.resize(d);
}

void Expectation::Add(const CompiledHmm& hmm, const SequenceView& sequence) {
  const size_t size = static_cast<size_t>(sequence.frames) * states_;
  if (belief_.size() < size) {
    belief_.resize(size);
    log_belief_.resize(size);
    predicted_.resize(size);
    log_predicted_.resize(size);
  }
  Forward(hmm, sequence);
  Backward(hmm, sequence);
}

void Expectation::Forward(const CompiledHmm& hmm,
                          const SequenceView& sequence) {
  std::ranges::copy(hmm.start(), predicted_.begin());
  std::ranges::copy(hmm.log_start(), log_predicted_.begin());
  CompensatedSum log_likelihood;
  for (int t = 0; t < sequence.frames; ++t) {
    const size_t row = static_cast<size_t>(t) * states_;
    const Belief belief{&belief_[row], &log_belief_[row]};
    const Belief predicted{&predicted_[row], &log_predicted_[row]};
    if (t > 0) {
      const size_t last = row - states_;
      Predict(hmm, {&belief_[last], &log_belief_[last]}, predicted);
    }
    hmm.emissions().LogDensity(sequence.frame(t), log_density_);
    log_likelihood.Add(Update(hmm, predicted, log_density_.data(), belief));
  }
  log_likelihood_ += log_likelihood.value();
}

void Expectation::Backward(const CompiledHmm& hmm,
                           const SequenceView& sequence) {
  const int last = sequence.frames - 1;
  std::copy_n(&belief_[static_cast<size_t>(last) * states_], states_,
              share_.begin());
  AddFrame(share_.data(), sequence.frame(last).data());
  for (int t = last - 1; t >= 0; --t) {
    const size_t row = static_cast<size_t>(t) * states_;
    const double* belief = &belief_[row];
    const double* log_belief = &log_belief_[row];
    const double* predicted = &predicted_[row + states_];
    const double* log_predicted = &log_predicted_[row + states_];
    next_share_.swap(share_);
    std::ranges::fill(share_, 0.0);
    for (int j = 0; j < states_; ++j) {
      if (next_share_[j] < kNegligibleShare) continue;
      const CompiledHmm::Incoming incoming = hmm.incoming(j);
      const bool trusted = predicted[j] > kTrustedSum;
      const double factor = trusted ? next_share_[j] / predicted[j] : 0;
      for (int i = incoming.first; i < incoming.last; ++i) {
        const int k = i - incoming.first;
        double taken = belief[i] * incoming.probability[k] * factor;
        if (!trusted) {
          const double exponent =
              log_belief[i] + incoming.log_probability[k] - log_predicted[j];
          taken = exponent > kNegligibleExponent
                      ? next_share_[j] * std::exp(exponent)
                      : 0;
        }
        transitions_[static_cast<size_t>(i) * states_ + j] += taken;
        share_[i] += taken;
      }
    }
    AddFrame(share_.data(), sequence.frame(t).data());
  }
  for (int j = 0; j < states_; ++j) starts_[j] += share_[j];
}

void Expectation::AddFrame(const double* share, const double* frame) {
  const int d = dimensions_;
  for (int j = 0; j < states_; ++j) {
    const double weight = share[j];
    if (weight < kNegligibleShare) continue;
    occupancy_[j] += weight;
    const double* mean = &means_[static_cast<size_t>(j) * d];
    double* first = &first_[static_cast<size_t>(j) * d];
    double* second = &second_[static_cast<size_t>(j) * d * d];
    for (int a = 0; a < d; ++a) {
      difference_[a] = frame[a] - mean[a];
      const double weighted = weight * difference_[a];
      first[a] += weighted;
      for (int b = full_ ? 0 : a; b <= a; ++b) {
        second[a * d + b] += weighted * difference_[b];
      }
    }
  }
}

}  // namespace tactus
