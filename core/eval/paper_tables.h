// File: paper_tables.h
//
// The paper's published results as data: the accuracies of its two summary
// tables, row by row, to set ours beside.
//
//   for (const PaperRow& row : PaperTable(Experiment::kSimulation)) {
//     row.accuracy_percent;  // 82.13 for HMM, f + m
//   }
//
// All by leave-one-condition-out: train on three of the four combinations of
// stiffness and velocity, test on the fourth. Rows are correct trials over all
// trials, but for the LSTMs in simulation: five of those are no whole number
// out of 1,835 and must be means over folds or runs.
//
// The source prints confusion matrices as figures only, so there is none here.
//
// Constant data; thread-safe.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/eval/evaluation.h"
#include "core/features/feature.h"

namespace tactus::internal {

enum class Experiment {
  // Section "Experiments with Physics-Based Simulations": 1,835 trials of 5 s.
  kSimulation,
  // Section "Experiments with a Real Robot": 240 trials of 1.2 s.
  kCody,
};

struct PaperRow {
  Algorithm algorithm = Algorithm::kHmm;
  // In the paper's notation, without spaces: "f+m+a".
  absl::string_view features;
  double accuracy_percent = 0;
};

struct PaperSource {
  // "simulation" or "cody".
  absl::string_view name;
  // The table's label in the paper's source.
  absl::string_view table;
  int trials = 0;
  double seconds = 0;
  // Row "Majority Classifier".
  double majority_percent = 0;
};

PaperSource SourceOf(Experiment experiment);

// 3 algorithms x 7 feature sets: HMM, LSTM, 1-NN, each with f, m, a, f+m, f+a,
// m+a, f+m+a. The paper ranks its rows by accuracy instead.
std::span<const PaperRow> PaperTable(Experiment experiment);

// "f+m+a" as features, in that order.
std::vector<Feature> PaperFeatures(absl::string_view features);

// "HMM", "LSTM" or "1-NN", as the paper writes them; "fused" for our own.
absl::string_view PaperName(Algorithm algorithm);

}  // namespace tactus::internal
