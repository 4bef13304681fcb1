// File: frontier.h
//
// Points of run time against error, one per variant, as a table, as benchmark
// rows and as pictures.
//
//   std::vector<FrontierPoint> points = ...;
//   MarkFronts(points);
//   file << FrontierTable(points);
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/labelled_contact.h"
#include "tests/bench/benchmark.h"
#include "tests/bench/frontier_models.h"

namespace tactus::internal::client {

// Points of one comparison are compared with each other.
enum class Comparison { kClassifier, kPrecision, kSimulator };

struct FrontierPoint {
  Comparison comparison = Comparison::kClassifier;
  // Variants of one family differ in size or tolerance: "HMMs".
  std::string family = {};
  std::string variant = {};
  // Time per contact frame; kPrecision: per scored frame.
  double nanoseconds = 0;
  // Largest difference from the reference; absent for classifiers.
  std::optional<double> error = {};
  std::string error_reference = {};
  // How many contacts were classified.
  size_t contacts = 0;
  // The fraction of them that are classified correctly 1.2 s after onset.
  double accuracy = 0;
  // The same at the end of the contacts; absent if not measured.
  std::optional<double> final_accuracy = {};
  // True if no other point of the comparison is faster and at most as wrong, or
  // as fast and less wrong.
  bool front = false;

  // The error axis of the comparison: `error`, or wrong answers in %.
  double Wrong() const { return error ? *error : 100 * (1 - accuracy); }
};

void MarkFronts(std::vector<FrontierPoint>& points);

// CSV with the columns comparison, family, variant, ns_per_frame, error,
// contacts, accuracy, final_accuracy, front. Absent values are empty.
std::string FrontierTable(const std::vector<FrontierPoint>& points);

std::vector<BenchRow> FrontierRows(const std::vector<FrontierPoint>& points);

// Writes frontier-COMPARISON.png for each comparison to `folder`, which is
// created. IO if a file cannot be written.
absl::Status DrawFrontiers(const std::vector<FrontierPoint>& points,
                           const std::string& folder);

// The three comparisons. Times are medians of rounds in which the variants take
// turns. They fail with NUMERICAL_FAILURE if an error exceeds the variant's
// stated bound.

// Accuracies are measured at this time after onset.
inline constexpr double kFrontierSeconds = 1.2;

struct MeasuredClassifiers {
  std::vector<FrontierPoint> points;
  // The preset `tuned`.
  std::shared_ptr<const CompiledModel> tuned;
};

// The fraction of `contacts` that `model` classifies correctly kFrontierSeconds
// after onset.
absl::StatusOr<double> AccuracyOf(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<LabelledContact>& contacts);

absl::StatusOr<MeasuredClassifiers> MeasureClassifiers(
    const FrontierContacts& contacts, bool quick);

// An error is the largest of a class's log-likelihood, in nats per scored
// frame, against logarithms in long double. Returns NUMERICAL_FAILURE if an
// error exceeds the scorer's stated bound; pruned scorers state none.
absl::StatusOr<std::vector<FrontierPoint>> MeasurePrecision(
    const Model& model, const std::vector<LabelledContact>& contacts,
    bool quick);

// Simulates scenes of the grid. An error is the largest of a noiseless feature,
// relative to the feature's peak, against tests/reference/sim/long_double.h. An
// accuracy is that of `model` on the method's contacts with noise. Returns
// NUMERICAL_FAILURE if an error of the exact method exceeds its stated bound.
absl::StatusOr<std::vector<FrontierPoint>> MeasureSimulators(
    const std::shared_ptr<const CompiledModel>& model, bool quick);

}  // namespace tactus::internal::client
