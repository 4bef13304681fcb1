#include "core/eval/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tactus::internal {

int Outcome::answer() const {
  return static_cast<int>(
      std::max_element(probability.begin(), probability.end()) -
      probability.begin());
}

Confusion CountConfusion(std::span<const Outcome> outcomes, int classes) {
  Confusion confusion(classes, std::vector<int>(classes));
  for (const Outcome& outcome : outcomes) {
    ++confusion[outcome.label][outcome.answer()];
  }
  return confusion;
}

int CountRight(std::span<const Outcome> outcomes) {
  return static_cast<int>(
      std::count_if(outcomes.begin(), outcomes.end(),
                    [](const Outcome& o) { return o.answer() == o.label; }));
}

double Accuracy(std::span<const Outcome> outcomes) {
  if (outcomes.empty()) return 0;
  return static_cast<double>(CountRight(outcomes)) /
         static_cast<double>(outcomes.size());
}

double ExpectedCalibrationError(std::span<const Outcome> outcomes) {
  constexpr int kBins = 15;
  struct Bin {
    int count = 0;
    int right = 0;
    double probability = 0;
  };
  std::array<Bin, kBins> bins;
  for (const Outcome& outcome : outcomes) {
    const double top = outcome.probability[outcome.answer()];
    Bin& bin = bins[std::clamp(static_cast<int>(top * kBins), 0, kBins - 1)];
    ++bin.count;
    bin.right += outcome.answer() == outcome.label;
    bin.probability += top;
  }
  double error = 0;
  for (const Bin& bin : bins) error += std::abs(bin.right - bin.probability);
  return outcomes.empty() ? 0 : error / static_cast<double>(outcomes.size());
}

SureAnswers CountSure(std::span<const Outcome> outcomes,
                      std::span<const double> unknown, double least) {
  SureAnswers sure;
  for (size_t i = 0; i < outcomes.size(); ++i) {
    const int answer = outcomes[i].answer();
    if (unknown[i] >= 0.5 || outcomes[i].probability[answer] < least) continue;
    ++sure.count;
    sure.right += answer == outcomes[i].label;
  }
  return sure;
}

std::vector<double> TopProbabilities(std::span<const Outcome> outcomes,
                                     bool right) {
  std::vector<double> tops;
  for (const Outcome& outcome : outcomes) {
    const int answer = outcome.answer();
    if ((answer == outcome.label) != right) continue;
    tops.push_back(outcome.probability[answer]);
  }
  return tops;
}

double MeanLogLoss(std::span<const Outcome> outcomes) {
  constexpr double kMinProbability = 1e-12;
  double sum = 0;
  for (const Outcome& outcome : outcomes) {
    sum -=
        std::log(std::max(outcome.probability[outcome.label], kMinProbability));
  }
  return outcomes.empty() ? 0 : sum / static_cast<double>(outcomes.size());
}

double BrierScore(std::span<const Outcome> outcomes) {
  double sum = 0;
  for (const Outcome& outcome : outcomes) {
    for (size_t k = 0; k < outcome.probability.size(); ++k) {
      const double truth = static_cast<int>(k) == outcome.label ? 1 : 0;
      const double error = outcome.probability[k] - truth;
      sum += error * error;
    }
  }
  return outcomes.empty() ? 0 : sum / static_cast<double>(outcomes.size());
}

EstimateErrors SummariseErrors(std::span<const EstimateError> errors) {
  EstimateErrors summary;
  summary.count = static_cast<int>(errors.size());
  if (errors.empty()) return summary;
  std::vector<double> sizes;
  double squares = 0;
  int covered = 0;
  for (const EstimateError& e : errors) {
    sizes.push_back(std::abs(e.error));
    squares += e.error * e.error;
    covered += std::abs(e.error) <= e.deviation;
  }
  const auto middle = sizes.begin() + static_cast<ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double count = static_cast<double>(errors.size());
  summary.median = *middle;
  summary.root_mean_square = std::sqrt(squares / count);
  summary.covered = covered / count;
  return summary;
}

}  // namespace tactus::internal
