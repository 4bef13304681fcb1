#include "core/hmm/mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus {

absl::Status Validate(const HmmMixture& mixture) {
  const size_t count = mixture.components.size();
  if (count < 1 || count > static_cast<size_t>(limits::kMaxHmmsPerClass)) {
    return InvalidModel("components", count,
                        absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
  }
  if (mixture.log_weight.size() != count) {
    return InvalidModel("log_weight size", mixture.log_weight.size(),
                        absl::StrCat(count, ", one per component"));
  }
  double sum = 0;
  for (size_t k = 0; k < count; ++k) {
    const double w = mixture.log_weight[k];
    if (!std::isfinite(w) || w > 1e-9) {
      return InvalidModel(absl::StrCat("log_weight[", k, "]"), w,
                          "finite and at most 0");
    }
    sum += std::exp(w);
    TACTUS_RETURN_IF_ERROR(Validate(mixture.components[k]));
    if (mixture.components[k].dimensions != mixture.components[0].dimensions) {
      return InvalidModel(absl::StrCat("components[", k, "] dimensions"),
                          mixture.components[k].dimensions,
                          "the same for all components");
    }
  }
  if (std::abs(sum - 1) > 1e-9) {
    return InvalidModel("log_weight sum of exponentials", sum, "1");
  }
  return absl::OkStatus();
}

absl::StatusOr<CompiledMixture> CompiledMixture::Create(
    const HmmMixture& mixture) {
  TACTUS_RETURN_IF_ERROR(Validate(mixture));
  CompiledMixture compiled;
  compiled.log_weight_ = mixture.log_weight;
  for (const GaussianHmm& model : mixture.components) {
    TACTUS_ASSIGN_OR_RETURN(CompiledHmm hmm, CompiledHmm::Create(model));
    compiled.components_.push_back(std::move(hmm));
  }
  return compiled;
}

MixtureFilter::MixtureFilter(const CompiledMixture& mixture, Score score)
    : mixture_(&mixture) {
  for (const CompiledHmm& hmm : mixture.components()) {
    if (score == Score::kForward) {
      forward_.emplace_back(hmm);
    } else {
      viterbi_.emplace_back(hmm);
    }
  }
}

void MixtureFilter::Reset() {
  for (ForwardFilter& filter : forward_) filter.Reset();
  for (ViterbiFilter& filter : viterbi_) filter.Reset();
}

void MixtureFilter::Step(std::span<const double> observation) {
  for (ForwardFilter& filter : forward_) filter.Step(observation);
  for (ViterbiFilter& filter : viterbi_) filter.Step(observation);
}

void MixtureFilter::Skip(int missing) {
  for (ForwardFilter& filter : forward_) filter.Skip(missing);
  for (ViterbiFilter& filter : viterbi_) filter.Skip(missing);
}

double MixtureFilter::log_likelihood() const {
  const std::vector<double>& weight = mixture_->log_weight();
  const auto term = [&](size_t k) {
    return weight[k] + (viterbi_.empty() ? forward_[k].log_likelihood()
                                         : viterbi_[k].score());
  };
  double largest = -std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < weight.size(); ++k) {
    largest = std::max(largest, term(k));
  }
  double sum = 0;
  for (size_t k = 0; k < weight.size(); ++k) {
    sum += std::exp(term(k) - largest);
  }
  return largest + std::log(sum);
}

}  // namespace tactus
