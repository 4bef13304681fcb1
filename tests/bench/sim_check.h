// File: sim_check.h
//
// Errors of the exact contacts (core/sim/exact/exact.h) against the reference
// (tests/reference/sim/long_double.h): the largest error of any feature and
// sample, relative to the feature's peak.
//
//   WorstErrors worst;
//   TACTUS_ASSIGN_OR_RETURN(const auto truth, ReferenceFeatures(spec));
//   worst.Take(contact, truth);
//   TACTUS_RETURN_IF_ERROR(worst.Check());
//
// Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/random.h"
#include "core/sim/exact/simulate_contact.h"
#include "tests/reference/sim/cvode.h"

namespace tactus::internal::client {

// Options of the compared methods: CVODE at a relative tolerance, with absolute
// tolerances in proportion to its defaults, and the exact method at a skip
// tolerance.
SolverOptions CvodeAt(double tolerance);
SimulateOptions ExactAt(double skip_tolerance);

double FeatureError(const std::vector<FeatureVector>& got,
                    const std::vector<FeatureVector>& want);

// Noiseless features of the reference, sampled as the exact method's;
// `step_share` as there.
absl::StatusOr<std::vector<FeatureVector>> ReferenceFeatures(
    const TrialSpec& spec, double step_share = 0.7);

// A scene far from the paper's. It rings slower than 2 10^4 rad/s, so that the
// reference resolves it quickly.
TrialSpec RandomSpec(Random& random);

// The worst errors and their scenes, separately for scenes with and without
// skipped bounces.
class WorstErrors {
 public:
  void Take(const SimulatedContact& contact,
            const std::vector<FeatureVector>& truth);

  int compared() const { return compared_; }
  double error() const { return std::max(error_[0], error_[1]); }
  void Print(const char* what) const;
  // NUMERICAL_FAILURE if an error exceeds its bound: 1e-6 if every bounce was
  // solved, 1e-3 if some were skipped.
  absl::Status Check() const;

 private:
  int compared_ = 0;
  // By whether bounces were skipped.
  std::array<int, 2> count_ = {};
  std::array<double, 2> error_ = {};
  std::array<std::string, 2> where_;
};

struct SceneComparison {
  WorstErrors worst;
  double seconds = 0;  // processor time of the exact method
};

// Compares `count` scenes with the reference until `budget` seconds of
// processor time are used up, and reports on stderr. Fails as
// WorstErrors::Check().
absl::StatusOr<SceneComparison> CompareScenes(
    const char* what, int count, double budget,
    absl::FunctionRef<TrialSpec(int)> spec_of);

}  // namespace tactus::internal::client
