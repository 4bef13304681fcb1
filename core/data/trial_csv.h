// File: trial_csv.h
//
// A trial as CSV tables. ImportSignalsCsv (core/import/import.h) reads that of
// signals. Folders with a skin.json have those of frames
// (core/import/skin_folder_writer.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string table, SignalsToCsv(trial));
//   TACTUS_RETURN_IF_ERROR(WriteFileBytes("000007.csv", table));
//
// Numbers have the fewest digits that give the same bits when they are read,
// whatever the locale. Thread-safe: free functions without state.
#pragma once

#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

// `# key=value` lines, the header time,force,area,motion, and one line a frame.
// TRIAL_FILE_INVALID if the trial is not valid, has no signals, or has touches.
absl::StatusOr<std::string> SignalsToCsv(const Trial& trial);

// The frames alone: the header time,r0c0,r0c1,... (with three axes
// time,r0c0x,r0c0y,r0c0z,...), with poses x,y,z,qx,qy,qz,qw behind it, and one
// line a frame with the taxels in the trial's unit. `places` says which values
// of a frame are written, in which order, each by its place in the frame.
// TRIAL_FILE_INVALID if the trial is not valid or has no taxels.
absl::StatusOr<std::string> FramesToCsv(const Trial& trial,
                                        std::span<const size_t> places);

// The name of a value's column in it, "r0c0" or "r0c0x".
std::string TaxelColumn(const TaxelSeries& taxels, size_t place);

}  // namespace tactus::internal
