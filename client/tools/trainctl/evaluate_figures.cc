#include "client/tools/trainctl/evaluate_figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"

namespace tactus::client {
namespace {

// The best row of a table as a dashed line.
ReferenceLine BestOfPaper(Experiment experiment) {
  const auto table = PaperTable(experiment);
  const PaperRow& best = *std::max_element(
      table.begin(), table.end(), [](const PaperRow& a, const PaperRow& b) {
        return a.accuracy_percent < b.accuracy_percent;
      });
  return {.name = absl::StrFormat("paper's best (%s %s, %g s)",
                                  PaperName(best.algorithm), best.features,
                                  SourceOf(experiment).seconds),
          .y = best.accuracy_percent};
}

}  // namespace

std::vector<ReliabilityBin> ReliabilityBins(std::span<const Outcome> outcomes) {
  constexpr int kBins = 15;
  std::array<ReliabilityBin, kBins> sums;
  for (const Outcome& outcome : outcomes) {
    const int answer = outcome.answer();
    const double top = outcome.probability[answer];
    ReliabilityBin& bin =
        sums[std::clamp(static_cast<int>(top * kBins), 0, kBins - 1)];
    bin.mean_probability += top;
    bin.accuracy += answer == outcome.label;
    ++bin.count;
  }
  std::vector<ReliabilityBin> bins;
  for (ReliabilityBin& bin : sums) {
    if (bin.count == 0) continue;
    bin.mean_probability /= bin.count;
    bin.accuracy /= bin.count;
    bins.push_back(bin);
  }
  return bins;
}

LinePlot AnytimePlot(const std::vector<NamedEvaluation>& evaluations,
                     std::optional<Experiment> paper) {
  LinePlot plot;
  plot.title = "Accuracy while the touch lasts";
  plot.x = {.title = "time since onset (s)",
            .scale = AxisScale::kLog,
            .ticks = {std::begin(kAnytimeSeconds), std::end(kAnytimeSeconds)}};
  plot.y = {.title = "accuracy (%)", .low = 0, .high = 100};
  for (const NamedEvaluation& shown : evaluations) {
    Series series = {.name = shown.name};
    for (int i = 0; i < kAnytimeCount; ++i) {
      if (kAnytimeSeconds[i] > shown.seconds) break;
      series.x.push_back(kAnytimeSeconds[i]);
      series.y.push_back(100 * Accuracy(shown.evaluation->anytime[i]));
    }
    plot.series.push_back(std::move(series));
  }
  if (paper) plot.references.push_back(BestOfPaper(*paper));
  return plot;
}

LinePlot ReliabilityPlot(const std::vector<NamedEvaluation>& evaluations) {
  LinePlot plot;
  plot.title = "Are the probabilities right?";
  plot.diagonal = true;
  plot.x = {.title = "probability of the answer (%)", .low = 0, .high = 100};
  plot.y = {.title = "answers that are right (%)", .low = 0, .high = 100};
  for (const NamedEvaluation& shown : evaluations) {
    const std::vector<Outcome>& outcomes = shown.evaluation->final;
    Series series = {
        .name = absl::StrFormat("%s (calibration error %.3f)", shown.name,
                                ExpectedCalibrationError(outcomes))};
    for (const ReliabilityBin& bin : ReliabilityBins(outcomes)) {
      series.x.push_back(100 * bin.mean_probability);
      series.y.push_back(100 * bin.accuracy);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

absl::Status DrawAnytime(const std::vector<NamedEvaluation>& evaluations,
                         std::optional<Experiment> paper,
                         const std::string& path) {
  return WritePng(AnytimePlot(evaluations, paper), path);
}

absl::Status DrawReliability(const std::vector<NamedEvaluation>& evaluations,
                             const std::string& path) {
  return WritePng(ReliabilityPlot(evaluations), path);
}

}  // namespace tactus::client
