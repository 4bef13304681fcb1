// File: choose_cues.h
//
// Changes which cues a preset's models take, by the cues' names (docs/cues.md).
//
//   TACTUS_RETURN_IF_ERROR(
//       AddLstmCues("with_cues", {"force_pitch_short"}, options));
//   TACTUS_RETURN_IF_ERROR(LeaveOutCues("without_cues", {"log_drag"},
//   options));
//
// `field` is what the caller calls the list of names. Thread-safe: free
// functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/cues/cue.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// INVALID_CONFIG for a name that no cue has.
absl::StatusOr<std::vector<Cue>> CuesNamed(
    absl::string_view field, const std::vector<std::string>& names);

// Gives the LSTMs these cues, too. INVALID_CONFIG if they take one already, or
// if there are no LSTMs.
absl::Status AddLstmCues(absl::string_view field,
                         const std::vector<std::string>& names,
                         FitOptions& options);

// Takes these cues from the inputs of all models. INVALID_CONFIG if none takes
// one of them, or if some models would be left without inputs.
absl::Status LeaveOutCues(absl::string_view field,
                          const std::vector<std::string>& names,
                          FitOptions& options);

}  // namespace tactus::internal
