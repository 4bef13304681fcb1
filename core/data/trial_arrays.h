// File: trial_arrays.h
//
// A trial as named arrays, one for each dataset and attribute of the trial file
// (docs/formats.md), and `taxel_scale` for the scale of the taxels. What
// trial_npz.h and trial_zarr.h write and read.
//
//   TACTUS_ASSIGN_OR_RETURN(const NamedArrays arrays, TrialToArrays(trial));
//   TACTUS_ASSIGN_OR_RETURN(const std::string archive, NpzBytes(arrays));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/data/trial.h"
#include "core/files/npz.h"

namespace tactus::internal {

// By name; the bytes are those of a .npy file.
using NamedArrays = std::vector<std::pair<std::string, std::string>>;

// The same trial gives the same arrays. The id is not among them.
// TRIAL_FILE_INVALID if the trial is not valid.
absl::StatusOr<NamedArrays> TrialToArrays(const Trial& trial);

// TRIAL_FILE_INVALID naming `path` and the array. Needed are `time` and one of
// `signals` and `taxels`; an array of another name is refused. `path` is for
// error messages only.
absl::StatusOr<Trial> TrialFromArrays(absl::string_view path, NpzArrays named);

}  // namespace tactus::internal
