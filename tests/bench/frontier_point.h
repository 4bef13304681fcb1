// File: frontier_point.h
//
// Points of the frontier: what a variant costs and how wrong it is, as a
// table, as benchmark rows and as pictures.
//
//   std::vector<FrontierPoint> points = ...;
//   MarkFronts(points);
//   file << FrontierTable(points);
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tests/bench/benchmark.h"

namespace tactus::client {

// Points of one ladder are compared with each other.
enum class Ladder { kClassifier, kPrecision, kSimulator };

struct FrontierPoint {
  Ladder ladder = Ladder::kClassifier;
  // What the variant is a size or a tolerance of: "HMMs".
  std::string family = {};
  std::string variant = {};
  // Of a contact frame; kPrecision: of a frame that is scored.
  double nanoseconds = 0;
  // Largest difference from the reference; absent for classifiers.
  std::optional<double> error = {};
  std::string error_reference = {};
  // Share of the test contacts that are told right 1.2 s after onset.
  double accuracy = 0;
  // The same at the end of the contacts, where it was asked.
  std::optional<double> final_accuracy = {};
  // No other point of the ladder is faster and at most as wrong, or as fast and
  // less wrong.
  bool front = false;

  // What the ladder compares: `error`, or the share told wrong, %.
  double Wrong() const { return error ? *error : 100 * (1 - accuracy); }
};

void MarkFronts(std::vector<FrontierPoint>& points);

// ladder,family,variant,ns_per_frame,error,accuracy,final_accuracy,front as
// CSV; empty where absent.
std::string FrontierTable(const std::vector<FrontierPoint>& points);

std::vector<BenchRow> FrontierRows(const std::vector<FrontierPoint>& points);

// Writes frontier-LADDER.png for each ladder to `folder`, which is made. IO if
// one cannot be written.
absl::Status DrawFrontiers(const std::vector<FrontierPoint>& points,
                           const std::string& folder);

}  // namespace tactus::client
