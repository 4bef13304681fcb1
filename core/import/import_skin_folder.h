// File: import_skin_folder.h
//
// Imports a folder of recordings of any skin: a skin.json, a table of trials,
// and the files of frames that the table names (docs/formats.md, "Your own
// recordings").
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const size_t trials,
//       ImportSkinFolder("mine", {}, [&](Trial t) { return Use(t); }));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/import/import.h"

namespace tactus::internal {

// Every mistake is TRIAL_FILE_INVALID (or IO) with the file, the line of the
// table, and the field. Nothing outside of `folder` is read but the files that
// `options` names and the table beside its skin.json. If the thresholds come
// from idle frames, all files are read twice. With `only`, the name of a file
// or bag in the folder, that is the only trial, and there is no table.
absl::StatusOr<size_t> ImportSkinFolder(const std::string& folder,
                                        const ImportOptions& options,
                                        TrialSink sink,
                                        const std::string& only = "");

}  // namespace tactus::internal
