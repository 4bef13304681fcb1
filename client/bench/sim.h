// File: sim.h
//
// Work and precision of the contact simulator: processor time on one core
// against the largest error of the noiseless features, for the exact method
// and for CVODE at several tolerances, on the same trials.
//
//   TACTUS_ASSIGN_OR_RETURN(SimReport report, MeasureSim({}));
//   std::puts(report.rows.dump().c_str());
//
// Errors are shares of the feature's peak in the trial, against the
// independent integration of core/sim/reference.h; times are of the calling
// thread only.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "nlohmann/json.hpp"

namespace tactus::client {

struct SimBenchOptions {
  // A few trials and tolerances, for tests.
  bool quick = false;
  // Also compares every trial of the paper's set, not only the sample, and
  // this many random scenes with the reference. Takes many minutes.
  bool all = false;
  int random_scenes = 10'000;
};

struct SimReport {
  // name, unit, ours, peer, peer_name, ratio, error, error_reference.
  nlohmann::ordered_json rows;
  // method,tolerance,seconds,median_error,worst_error,trials as CSV.
  std::string table;
};

absl::StatusOr<SimReport> MeasureSim(const SimBenchOptions& options);

}  // namespace tactus::client
