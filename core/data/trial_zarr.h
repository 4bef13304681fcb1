// File: trial_zarr.h
//
// A trial as a group of Zarr, version 2: its arrays as in trial_arrays.h, and
// its texts and single numbers as attributes of the group.
//
//   TACTUS_RETURN_IF_ERROR(TrialToZarr(trial, "out/000007"));
//   TACTUS_ASSIGN_OR_RETURN(Trial back, TrialFromZarr("out/000007"));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

// `folder` must not exist. The id is not part of it: it is the folder's name.
// IO, or TRIAL_FILE_INVALID if the trial is not valid.
absl::Status TrialToZarr(const Trial& trial, const std::string& folder);

// IO or TRIAL_FILE_INVALID, naming the folder and the array.
absl::StatusOr<Trial> TrialFromZarr(const std::string& folder);

}  // namespace tactus::internal
