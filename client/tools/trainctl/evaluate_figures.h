// File: evaluate_figures.h
//
// Figures of what an evaluation found: accuracy while the touch lasts, and
// whether probabilities mean what they say.
//
//   const std::vector<NamedEvaluation> shown = {{"HMM", &result, 5}};
//   TACTUS_RETURN_IF_ERROR(DrawAnytime(shown, Experiment::kSimulation, path));
//   TACTUS_RETURN_IF_ERROR(DrawReliability(shown, other_path));
//
// Nothing is owned: evaluations must outlive the call. Thread-safe: free
// functions without state. Errors are those of WritePng.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tools/plot/figure.h"
#include "core/eval/evaluate.h"
#include "core/eval/metrics.h"
#include "core/eval/paper_tables.h"

namespace tactus::client {

struct NamedEvaluation {
  std::string name;
  const Evaluation* evaluation = nullptr;
  // Length of the longest contact; later times say nothing new and are left
  // out.
  double seconds = 5;
};

// Outcomes whose top probability falls into one of 15 equal-width bins, those
// of ExpectedCalibrationError.
struct ReliabilityBin {
  double mean_probability = 0;
  double accuracy = 0;
  int count = 0;
};

// Bins that hold an outcome, by increasing probability.
std::vector<ReliabilityBin> ReliabilityBins(std::span<const Outcome> outcomes);

// Accuracy (%) at kAnytimeSeconds since onset, on a logarithmic axis; dashed,
// the best row of the paper's table for `paper`.
LinePlot AnytimePlot(const std::vector<NamedEvaluation>& evaluations,
                     std::optional<Experiment> paper);
absl::Status DrawAnytime(const std::vector<NamedEvaluation>& evaluations,
                         std::optional<Experiment> paper,
                         const std::string& path);

// Share answered rightly against the probability claimed, after the last
// frame; the diagonal is what the claim promises.
LinePlot ReliabilityPlot(const std::vector<NamedEvaluation>& evaluations);
absl::Status DrawReliability(const std::vector<NamedEvaluation>& evaluations,
                             const std::string& path);

}  // namespace tactus::client
