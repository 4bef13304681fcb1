// File: evaluate_figures.h
//
// Figures of an evaluation: accuracy over the time since onset, whether
// probabilities mean what they promise, and how soon contacts are decided.
// Every accuracy has its 95 % interval.
//
//   const NamedEvaluation shown = {"fused", &result, 5};
//   TACTUS_RETURN_IF_ERROR(
//       DrawFigure(AnytimePlot(shown, Experiment::kSimulation), path));
//   TACTUS_RETURN_IF_ERROR(DrawFigure(ReliabilityPlot(shown), other_path));
//
// Nothing is owned: the evaluation must outlive the call. Thread-safe: free
// functions without state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/eval/evaluate.h"
#include "core/eval/paper_tables.h"
#include "tools/figures/line_plot.h"

namespace tactus::internal::client {

struct NamedEvaluation {
  // Name of the algorithm: "fused".
  std::string name;
  const Evaluation* evaluation = nullptr;
  // Length of the longest contact; there are no points at later times.
  double seconds = 5;
};

// Accuracy (%) at kAnytimeSeconds since onset, on a logarithmic axis, of the
// evaluation and, where it has them, of its HMMs and its LSTMs alone; dashed,
// the best row of the paper's table for `paper`. The y axis begins at 75, 50 or
// 0 %, the highest of these below everything shown.
LinePlot AnytimePlot(const NamedEvaluation& shown,
                     std::optional<Experiment> paper);

// The experiment of the paper that an evaluation may be compared with: that of
// simulated contacts with the paper's four classes. Nothing for others.
std::optional<Experiment> ComparableExperiment(const Evaluation& evaluation);

// Percentage of right answers over the claimed probability, after the last
// frame, with the number of contacts in each bin below; the diagonal is what
// the claim promises. No line passes through bins of fewer than 10 contacts.
LinePlot ReliabilityPlot(const NamedEvaluation& shown);

// Percentage of contacts that are decided, and decided rightly, by each time
// since onset.
LinePlot DecisionPlot(const NamedEvaluation& shown);

}  // namespace tactus::internal::client
