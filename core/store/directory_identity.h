// File: directory_identity.h
//
// A data directory knows that it was used, and its catalogue which directory it
// belongs to. Both hold the same random id: the folder in the file "marker",
// the catalogue in Table::kDirectory. Both also hold how often the directory
// was opened, so that an older copy of the catalogue is noticed.
//
//   TACTUS_RETURN_IF_ERROR(CheckCatalogFile(files, folder));
//   TACTUS_ASSIGN_OR_RETURN(auto catalog, OpenSqliteCatalog(path));
//   TACTUS_RETURN_IF_ERROR(CheckCatalogBelongs(files, folder, *catalog));
//   TACTUS_RETURN_IF_ERROR(MarkDirectory(files, folder, *catalog));
//
// Errors: DATA_LOST with what to restore, and those of storage. Thread-safe:
// free functions without state.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"
#include "core/store/file_system.h"

namespace tactus::internal {

// The file of a directory's catalogue.
std::string CatalogPath(absl::string_view folder);

// True if the folder has a marker, blobs or uploads.
absl::StatusOr<bool> DirectoryWasUsed(FileSystem& files,
                                      const std::string& folder);

// Refuses a directory that was used and whose catalogue does not exist or has
// no byte. Call it before the catalogue is opened, which would make a new one.
absl::Status CheckCatalogFile(FileSystem& files, const std::string& folder);

// Refuses a catalogue without records beside data that it does not name, and
// one of another directory. Directories of release 0.1.0 have no id; a
// catalogue with records is taken for theirs.
absl::Status CheckCatalogBelongs(FileSystem& files, const std::string& folder,
                                 const Catalog& catalog);

// True if the directory was opened more often than the catalogue knows: the
// catalogue is an older copy, or its write-ahead log was lost.
absl::StatusOr<bool> CatalogIsOlder(FileSystem& files,
                                    const std::string& folder,
                                    const Catalog& catalog);

// The id that the catalogue has; empty if it has none.
absl::StatusOr<std::string> DirectoryIdOf(const Catalog& catalog);

// How many blobs and files of uploads the folder holds.
int CountData(FileSystem& files, const std::string& folder);

// A random id of 32 hexadecimal digits.
absl::StatusOr<std::string> NewId();

// Counts one more start, and gives both the id of the folder, or else that of
// the catalogue, or else a new one.
absl::Status MarkDirectory(FileSystem& files, const std::string& folder,
                           Catalog& catalog);

// `status` with what to do about a catalogue that is damaged or not the right
// one, if it is DATA_LOST.
absl::Status WithRestoreAdvice(const std::string& folder,
                               const absl::Status& status);

}  // namespace tactus::internal
