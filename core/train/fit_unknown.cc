#include "core/train/fit_unknown.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/classify/calibration.h"

namespace tactus {
namespace {

// Otherwise a constant score would make every other contact unknown.
constexpr double kMinEvidenceDeviation = 0.1;
// The same for objects of one stiffness: a factor of two on each side is known.
constexpr double kLeastKnownStiffness = 0.3;  // log10 N/m

// What is compared, of the contacts at one time. Both are sorted.
struct Spread {
  std::vector<double> evidence;
  std::vector<double> stiffness;
};

// One contact with an estimate at that time.
struct Estimated {
  double evidence = 0;
  double stiffness = 0;
};

double Quantile(std::span<const double> sorted, double fraction) {
  return sorted[static_cast<size_t>(fraction *
                                    static_cast<double>(sorted.size() - 1))];
}

// Borders beyond which the fraction `level` of the contacts lies, in each of
// the two scores.
struct Borders {
  Borders(const Spread& spread, double level)
      : evidence(Quantile(spread.evidence, level)),
        low(Quantile(spread.stiffness, level / 2)),
        high(Quantile(spread.stiffness, 1 - level / 2)) {}

  bool Within(const Estimated& contact) const {
    return contact.evidence >= evidence && contact.stiffness >= low &&
           contact.stiffness <= high;
  }

  double evidence;
  double low;
  double high;
};

double Evidence(const ScoredContact& contact, size_t time) {
  const auto& scores = contact.log_likelihood[time];
  return *std::max_element(scores.begin(), scores.end()) /
         std::max(contact.hmm_steps[time], 1.0);
}

bool HasEstimate(const ScoredContact& contact, size_t time) {
  return !contact.log10_stiffness.empty() &&
         !std::isnan(contact.log10_stiffness[time]);
}

// The largest level at which at most kFalseAlarms of the contacts lie beyond
// any border. Some lie beyond two, so it is between half of that and all of it.
double Level(const Spread& spread, std::span<const Estimated> contacts) {
  const auto too_many = [&](double level) {
    const Borders borders(spread, level);
    const auto beyond =
        std::count_if(contacts.begin(), contacts.end(),
                      [&](const Estimated& c) { return !borders.Within(c); });
    return static_cast<double>(beyond) >
           kFalseAlarms * static_cast<double>(contacts.size());
  };
  constexpr int kHalvings = 20;
  double low = kFalseAlarms / 2;
  double high = kFalseAlarms;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (too_many(middle) ? high : low) = middle;
  }
  return low;
}

void FitAt(std::span<const ScoredContact> contacts, size_t time,
           bool with_stiffness, Calibration& c) {
  Spread spread;
  std::vector<Estimated> estimated;
  for (const ScoredContact& contact : contacts) {
    const double evidence = Evidence(contact, time);
    spread.evidence.push_back(evidence);
    if (!with_stiffness || !HasEstimate(contact, time)) continue;
    estimated.push_back({evidence, contact.log10_stiffness[time]});
    spread.stiffness.push_back(estimated.back().stiffness);
  }
  std::sort(spread.evidence.begin(), spread.evidence.end());
  std::sort(spread.stiffness.begin(), spread.stiffness.end());
  const double level = with_stiffness ? Level(spread, estimated) : kFalseAlarms;
  const double median = Quantile(spread.evidence, 0.5);
  c.evidence_median.push_back(median);
  c.evidence_deviation.push_back(
      std::max((median - Quantile(spread.evidence, level)) / kUnknownDeviations,
               kMinEvidenceDeviation));
  if (!with_stiffness) return;
  const Borders borders(spread, level);
  const double middle = Quantile(spread.stiffness, 0.5);
  c.stiffness_low.push_back(
      std::min(borders.low, middle - kLeastKnownStiffness));
  c.stiffness_high.push_back(
      std::max(borders.high, middle + kLeastKnownStiffness));
}

}  // namespace

void FitUnknown(std::span<const ScoredContact> contacts,
                Calibration& calibration) {
  Calibration& c = calibration;
  for (auto* table : {&c.evidence_median, &c.evidence_deviation,
                      &c.stiffness_low, &c.stiffness_high}) {
    table->clear();
  }
  bool with_stiffness = true;
  for (size_t time = 0; time < c.frames.size(); ++time) {
    const auto estimates = std::count_if(
        contacts.begin(), contacts.end(),
        [&](const ScoredContact& s) { return HasEstimate(s, time); });
    with_stiffness &= static_cast<size_t>(estimates) >= kMinEstimates;
  }
  for (size_t time = 0; time < c.frames.size(); ++time) {
    FitAt(contacts, time, with_stiffness, c);
  }
}

}  // namespace tactus
