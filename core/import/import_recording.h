// File: import_recording.h
//
// Imports a recording of tactus-stream: each contact becomes a trial, cut at
// its onset and release (core/data/recording/contact_cutter.h). Labels come
// from the recording, or from a table with a row per contact (docs/formats.md,
// "Recordings").
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const size_t trials,
//       ImportRecording("run.mcap", {}, [&](Trial t) { return Use(t); }));
//
// Not thread-safe.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/import/import.h"

namespace tactus::internal {

// TRIAL_FILE_INVALID, DATA_LOST or IO with the file and the contact, or the
// line of the table. options.remark gets a text for everything that is left
// out, and for a recording that was cut off.
absl::StatusOr<size_t> ImportRecording(const std::string& path,
                                       const ImportOptions& options,
                                       TrialSink sink);

}  // namespace tactus::internal
