#include "tools/trainctl/report/evaluate_figures.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/eval/metrics.h"
#include "core/eval/reliability.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

// A bin of fewer contacts says little: its interval is wide.
constexpr int kFewContacts = 10;

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

void AppendAccuracy(double x, int right, int count, Series& series) {
  const Interval interval = WilsonInterval(right, count);
  series.x.push_back(x);
  series.y.push_back(100. * right / count);
  series.low.push_back(100 * interval.low);
  series.high.push_back(100 * interval.high);
}

Series AnytimeSeries(const std::string& name,
                     const std::vector<std::vector<Outcome>>& anytime,
                     double seconds) {
  Series series = {.name = name};
  for (int i = 0; i < kAnytimeCount; ++i) {
    if (kAnytimeSeconds[i] > seconds || anytime[i].empty()) break;
    AppendAccuracy(kAnytimeSeconds[i], CountRight(anytime[i]),
                   static_cast<int>(anytime[i].size()), series);
  }
  return series;
}

// Where the y axis begins.
double LowestPercent(const LinePlot& plot) {
  double least = 100;
  for (const ReferenceLine& line : plot.references) {
    least = std::min(least, line.y);
  }
  for (const Series& series : plot.series) {
    for (const double low : series.low) least = std::min(least, low);
  }
  for (const double low : {75., 50.}) {
    if (least >= low) return low;
  }
  return 0;
}

}  // namespace

LinePlot AnytimePlot(const NamedEvaluation& shown,
                     std::optional<Experiment> paper) {
  const Evaluation& evaluation = *shown.evaluation;
  LinePlot plot;
  plot.title = "Accuracy while the touch lasts";
  plot.subtitle =
      absl::StrCat(WithCommas(static_cast<int>(evaluation.final.size())),
                   " felt contacts; bands are 95 % intervals");
  plot.x = {.title = "time since onset (s)",
            .scale = AxisScale::kLog,
            .ticks = {std::begin(kAnytimeSeconds), std::end(kAnytimeSeconds)}};
  plot.series = {AnytimeSeries(shown.name, evaluation.anytime, shown.seconds)};
  if (!evaluation.anytime_hmm.empty()) {
    plot.series.push_back(
        AnytimeSeries("HMMs alone", evaluation.anytime_hmm, shown.seconds));
    plot.series.push_back(
        AnytimeSeries("LSTMs alone", evaluation.anytime_lstm, shown.seconds));
  }
  if (paper) plot.references.push_back(BestOfPaper(*paper));
  plot.y = {.title = "accuracy (%)", .low = LowestPercent(plot), .high = 100};
  return plot;
}

std::optional<Experiment> ComparableExperiment(const Evaluation& evaluation) {
  const std::vector<std::string> categories = {"HU", "HM", "SU", "SM"};
  // Only simulations know how the object moved.
  if (evaluation.class_names != categories || evaluation.so_far.empty()) {
    return std::nullopt;
  }
  return Experiment::kSimulation;
}

LinePlot ReliabilityPlot(const NamedEvaluation& shown) {
  const std::vector<Outcome>& outcomes = shown.evaluation->final;
  const std::vector<ReliabilityBin> bins = ReliabilityBins(outcomes);
  LinePlot plot;
  plot.title = "Are the probabilities right?";
  plot.subtitle = absl::StrFormat(
      "%s felt contacts; calibration error %.3f; bars are 95 %% intervals",
      WithCommas(static_cast<int>(outcomes.size())),
      ExpectedCalibrationError(outcomes));
  plot.diagonal = "probability = accuracy";
  plot.few_name = absl::StrCat("fewer than ", kFewContacts, " contacts");
  plot.x = {.title = "probability of the answer (%)", .low = 0, .high = 100};
  plot.y = {.title = "right answers (%)", .low = 0, .high = 100};
  plot.counts = {.title = "contacts"};
  Series series = {.name = shown.name, .interval = IntervalStyle::kBars};
  for (const ReliabilityBin& bin : bins) {
    AppendAccuracy(100 * bin.mean_probability, bin.right, bin.count, series);
    series.few.push_back(bin.count < kFewContacts);
  }
  if (!bins.empty()) {
    // The axis begins with the first bin that holds a contact.
    plot.x.low = 100 * bins.front().low;
    const int first =
        static_cast<int>(std::lround(bins.front().low * kReliabilityBins));
    plot.counts.counts.assign(kReliabilityBins - first, 0);
    for (int i = first; i <= kReliabilityBins; ++i) {
      plot.counts.edges.push_back(100. * i / kReliabilityBins);
    }
    for (const ReliabilityBin& bin : bins) {
      const int i = static_cast<int>(std::lround(bin.low * kReliabilityBins));
      plot.counts.counts[i - first] = bin.count;
    }
  }
  plot.series = {std::move(series)};
  return plot;
}

LinePlot DecisionPlot(const NamedEvaluation& shown) {
  constexpr int kPoints = 100;
  const auto& decisions = shown.evaluation->decisions;
  const int count = static_cast<int>(decisions.size());
  LinePlot plot;
  plot.title = "How soon contacts are decided";
  plot.subtitle = absl::StrCat(WithCommas(count),
                               " felt contacts; bands are 95 % intervals");
  plot.x = {.title = "time since onset (s)", .low = 0, .high = shown.seconds};
  plot.y = {.title = "contacts (%)", .low = 0, .high = 100};
  Series decided = {.name = "decided", .markers = false};
  Series rightly = {.name = "decided rightly", .markers = false};
  for (int i = 0; i <= kPoints; ++i) {
    const double seconds = shown.seconds * i / kPoints;
    int before = 0;
    int right = 0;
    for (const auto& decision : decisions) {
      if (!decision || decision->seconds > seconds + 1e-9) continue;
      ++before;
      right += decision->right;
    }
    AppendAccuracy(seconds, before, count, decided);
    AppendAccuracy(seconds, right, count, rightly);
  }
  plot.series = {std::move(decided), std::move(rightly)};
  return plot;
}

}  // namespace tactus::internal::client
