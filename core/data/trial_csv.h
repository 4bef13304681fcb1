// File: trial_csv.h
//
// A trial as CSV tables. The table of signals is what ImportSignalsCsv
// (core/import/import.h) reads.
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string table, SignalsToCsv(trial));
//   TACTUS_RETURN_IF_ERROR(WriteFileBytes("000007.csv", table));
//
// Numbers have the fewest digits that give the same bits when they are read,
// whatever the locale. Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

// `# key=value` lines, the header time,force,area,motion, and one line a frame.
// TRIAL_FILE_INVALID if the trial is not valid or has no signals.
absl::StatusOr<std::string> SignalsToCsv(const Trial& trial);

// The same attributes, the header time,r0c0,r0c1,... (with three axes
// time,r0c0x,r0c0y,r0c0z,...) and one line a frame with the taxels in the
// trial's unit. TRIAL_FILE_INVALID if the trial is not valid or has no taxels.
absl::StatusOr<std::string> TaxelsToCsv(const Trial& trial);

}  // namespace tactus::internal
