// File: mixture.h
//
// A category modelled by several HMMs: log p(o | category) =
// log sum_k weight_k p(o | hmm_k). One component is the paper's model; several
// are clusters of trials (train_mixture.h).
//
//   TACTUS_ASSIGN_OR_RETURN(auto mixture, CompiledMixture::Create(model));
//   MixtureFilter filter(mixture, Score::kForward);
//   filter.Step(observation);
//   filter.log_likelihood();
//
// Thread-safety: CompiledMixture is immutable and thread-safe; a filter belongs
// to one stream. The mixture must outlive its filters.
#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/hmm/compiled_hmm.h"
#include "core/hmm/forward.h"
#include "core/hmm/gaussian_hmm.h"

namespace tactus {

// K components of equal dimensions; plain data.
struct HmmMixture {
  std::vector<double> log_weight;       // [K], natural logarithms
  std::vector<GaussianHmm> components;  // [K]
};

// Refuses with INVALID_MODEL: no or too many components, sizes that differ,
// weights that do not sum to 1 within 1e-9 (a weight of 0, log -infinity, is
// refused too), a component that is not valid.
absl::Status Validate(const HmmMixture& mixture);

class CompiledMixture {
 public:
  // Fails as Validate(mixture) does.
  static absl::StatusOr<CompiledMixture> Create(const HmmMixture& mixture);

  int dimensions() const { return components_.front().dimensions(); }
  const std::vector<double>& log_weight() const { return log_weight_; }
  const std::vector<CompiledHmm>& components() const { return components_; }

 private:
  CompiledMixture() = default;

  std::vector<double> log_weight_;
  std::vector<CompiledHmm> components_;
};

// What a component's share is: its likelihood summed over state paths, or that
// of its best path, as the paper scored.
enum class Score { kForward = 0, kViterbi = 1 };

class MixtureFilter {
 public:
  MixtureFilter(const CompiledMixture& mixture, Score score);

  // As for ForwardFilter; nothing here allocates.
  void Reset();
  void Step(std::span<const double> observation);
  void Skip(int missing);

  // log sum_k exp(log_weight_k + log-likelihood or Viterbi score of k); finite.
  double log_likelihood() const;

 private:
  const CompiledMixture* mixture_;
  // One of the two is empty.
  std::vector<ForwardFilter> forward_;
  std::vector<ViterbiFilter> viterbi_;
};

}  // namespace tactus
