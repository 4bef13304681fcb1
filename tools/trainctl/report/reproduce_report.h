// File: reproduce_report.h
//
// The results of `trainctl reproduce` beside the paper's: as aligned text, as
// JSON and as figures.
//
//   std::cout << TableHeading(experiment) << TableLine(row);
//   std::cout << ConfusionBlocks(rows);
//   TACTUS_RETURN_IF_ERROR(WriteFigures(rows, "figures"));
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/eval/metrics.h"
#include "core/eval/paper_tables.h"
#include "tools/figures/bar_chart.h"
#include "tools/figures/confusion_matrix.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// One row of a table of the paper and its result here.
struct ReproducedRow {
  Experiment experiment = Experiment::kSimulation;
  PaperRow paper;
  // Absent if the row could not be computed; `reason` is then the error.
  std::optional<double> ours_percent;
  std::string reason;
  // Trials simulated; those of them that the skin never felt are not counted.
  int trials = 0;
  int never_felt = 0;
  // Classes of the contacts classified; empty without an answer.
  std::vector<std::string> class_names;
  Confusion confusion;
  double seconds = 0;

  // Ours minus the paper's, percentage points.
  std::optional<double> Difference() const;
  // The contacts classified and those classified rightly, by the confusion
  // matrix.
  int felt() const;
  int right() const;
};

// Two lines: the title of the table and the names of its columns.
std::string TableHeading(Experiment experiment);

// One line, aligned with the heading's columns.
std::string TableLine(const ReproducedRow& row);

// The confusion matrices of the rows of one experiment that have one, those of
// one feature set side by side.
std::string ConfusionBlocks(const std::vector<ReproducedRow>& rows);

Json RowToJson(const ReproducedRow& row);

// Ours and the paper's accuracies as bars, a section per algorithm. `rows`, at
// least one, are of one experiment. The paper's intervals take its numbers of
// trials.
BarChart AccuracyChart(const std::vector<ReproducedRow>& rows);

// The confusion matrix of a row that has one.
ConfusionMatrix ConfusionFigure(const ReproducedRow& row);

// Writes into `folder` EXPERIMENT-accuracy.png and, for each confusion matrix,
// EXPERIMENT-confusion-ALGORITHM-FEATURES.png. `rows`, at least one, are of
// one experiment.
absl::Status WriteFigures(const std::vector<ReproducedRow>& rows,
                          const std::string& folder);

}  // namespace tactus::internal::client
