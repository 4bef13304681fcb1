// File: accept_catalog.h
//
// The way out when the catalogue of a data directory is lost: takes what is
// there as the catalogue of the directory.
//
//   TACTUS_ASSIGN_OR_RETURN(auto done, AcceptCatalog(files, "/data"));
//   Print(done);  // "there was none; a new one begins without records"
//
// Deletes nothing. Thread-safe: a free function without state; the caller holds
// the lock of the directory.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/store/file_system.h"

namespace tactus::internal {

// Makes a catalogue without records if there is none or it is damaged, after
// moving the damaged one to lost+found; else takes its records as they are. The
// catalogue gets the id of the directory. Returns what was done.
absl::StatusOr<std::string> AcceptCatalog(FileSystem& files,
                                          const std::string& folder);

}  // namespace tactus::internal
