// File: directory_to_copy.h
//
// DirectoryToCopy: a data directory that no server uses, as a side of a copy
// (data_copy.h). It holds the directory's lock.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto from, OpenDirectoryToCopy(files, "/a"));
//   TACTUS_ASSIGN_OR_RETURN(const auto to, MakeDirectoryToCopy(files, "/b"));
//   TACTUS_ASSIGN_OR_RETURN(const CopyReport report,
//                           CopyData(files, from->place(), to->place()));
//
// Thread-safe: it does not change.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "core/store/catalog.h"
#include "core/store/data_copy.h"
#include "core/store/directory_lock.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class DirectoryToCopy {
 public:
  DirectoryToCopy(std::string folder, std::unique_ptr<DirectoryLock> lock,
                  std::unique_ptr<Catalog> catalog)
      : folder_(std::move(folder)),
        lock_(std::move(lock)),
        catalog_(std::move(catalog)) {}

  // Valid as long as this object.
  CopyPlace place() const {
    return {.catalog = catalog_.get(), .folder = folder_};
  }

 private:
  const std::string folder_;
  // Ends after the catalogue.
  const std::unique_ptr<DirectoryLock> lock_;
  const std::unique_ptr<Catalog> catalog_;
};

// A source. IO if a server uses it, or if it is no data directory; DATA_LOST.
absl::StatusOr<std::unique_ptr<DirectoryToCopy>> OpenDirectoryToCopy(
    FileSystem& files, const std::string& folder);

// A target, which is made if it is not there. IO if a server uses it;
// DATA_LOST. `vfs`: as OpenSqliteCatalog.
absl::StatusOr<std::unique_ptr<DirectoryToCopy>> MakeDirectoryToCopy(
    FileSystem& files, const std::string& folder, const std::string& vfs = "");

}  // namespace tactus::internal
