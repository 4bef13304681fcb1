// File: trial_npz.h
//
// A trial as NumPy's .npz: one array for each dataset and attribute of the
// trial file, under the same names (docs/formats.md), and `taxel_scale` for the
// scale of the taxels.
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string bytes, TrialToNpz(trial));
//   TACTUS_ASSIGN_OR_RETURN(Trial back, TrialFromNpz("000007.npz", bytes));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/data/trial.h"

namespace tactus::internal {

// The same trial gives the same bytes. The id is not part of them: it is the
// file's name. TRIAL_FILE_INVALID if the trial is not valid.
absl::StatusOr<std::string> TrialToNpz(const Trial& trial);

// TRIAL_FILE_INVALID naming `path` and the array. Needed are `time` and one of
// `signals` and `taxels`; an array of another name is refused. `path` is for
// error messages only.
absl::StatusOr<Trial> TrialFromNpz(absl::string_view path,
                                   absl::string_view bytes);

}  // namespace tactus::internal
