#include "core/train/fit_unknown.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/classify/calibration.h"

namespace tactus::internal {
namespace {

// Otherwise a constant score would make every other contact unknown.
constexpr double kMinEvidenceDeviation = 0.1;
// The border lies at least this far below the median, log10 N/m. Otherwise
// small errors would make contacts with objects of one stiffness unknown. 0.3
// is half of the stiffness.
constexpr double kMinStiffnessRange = 0.3;

double Quantile(std::span<const double> sorted, double fraction) {
  return sorted[static_cast<size_t>(fraction *
                                    static_cast<double>(sorted.size() - 1))];
}

std::vector<double> SortedEvidence(std::span<const ScoredContact> contacts,
                                   size_t time) {
  std::vector<double> evidence;
  for (const ScoredContact& contact : contacts) {
    const auto& scores = contact.log_likelihood[time];
    evidence.push_back(*std::max_element(scores.begin(), scores.end()) /
                       std::max(contact.hmm_steps[time], 1.0));
  }
  std::sort(evidence.begin(), evidence.end());
  return evidence;
}

// The stiffnesses of the contacts that have an estimate.
std::vector<double> SortedStiffness(std::span<const ScoredContact> contacts,
                                    size_t time) {
  std::vector<double> stiffness;
  for (const ScoredContact& contact : contacts) {
    if (contact.log10_stiffness.empty()) continue;
    const double estimate = contact.log10_stiffness[time];
    if (!std::isnan(estimate)) stiffness.push_back(estimate);
  }
  std::sort(stiffness.begin(), stiffness.end());
  return stiffness;
}

void FitSoftest(std::span<const ScoredContact> contacts, Calibration& c) {
  c.softest.clear();
  for (size_t time = 0; time < c.frames.size(); ++time) {
    const auto stiffness = SortedStiffness(contacts, time);
    if (stiffness.size() < kMinEstimates) {
      c.softest.clear();
      return;
    }
    c.softest.push_back(
        std::min(Quantile(stiffness, kSoftFalseAlarms),
                 Quantile(stiffness, 0.5) - kMinStiffnessRange));
  }
}

}  // namespace

void FitUnknown(std::span<const ScoredContact> contacts,
                Calibration& calibration) {
  Calibration& c = calibration;
  FitSoftest(contacts, c);
  const double left =
      kFalseAlarms - (c.softest.empty() ? 0.0 : kSoftFalseAlarms);
  c.evidence_median.clear();
  c.evidence_deviation.clear();
  for (size_t time = 0; time < c.frames.size(); ++time) {
    const auto evidence = SortedEvidence(contacts, time);
    const double median = Quantile(evidence, 0.5);
    c.evidence_median.push_back(median);
    c.evidence_deviation.push_back(
        std::max((median - Quantile(evidence, left)) / kUnknownDeviations,
                 kMinEvidenceDeviation));
  }
}

}  // namespace tactus::internal
