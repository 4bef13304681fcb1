#include "core/store/accept_catalog.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/directory_identity.h"
#include "core/store/lost_and_found.h"
#include "core/store/sqlite_catalog.h"

namespace tactus::internal {
namespace {

// Moves the files of the catalogue. Returns where to; empty if there were none.
absl::StatusOr<std::string> MoveCatalog(FileSystem& files,
                                        const std::string& folder) {
  LostAndFound lost(files, folder);
  for (const char* name : {"catalog.db", "catalog.db-wal", "catalog.db-shm"}) {
    TACTUS_ASSIGN_OR_RETURN(const int64_t size,
                            files.Size(absl::StrCat(folder, "/", name)));
    if (size >= 0) TACTUS_RETURN_IF_ERROR(lost.Take(name));
  }
  return lost.folder();
}

}  // namespace

absl::StatusOr<std::string> AcceptCatalog(FileSystem& files,
                                          const std::string& folder) {
  const std::string path = CatalogPath(folder);
  std::string done = "its records are taken as they are";
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files.Size(path));
  absl::Status status;
  if (size > 0) {
    const auto version = CatalogVersionOf(path);
    if (version.ok() && *version > kCatalogVersion) {
      return IoError(path,
                     absl::StrCat("has version ", *version,
                                  " of a newer release; use its trainctl"));
    }
    status = AcceptRecords(path);
  }
  if (!status.ok() && !absl::IsDataLoss(status)) return status;
  if (size <= 0 || !status.ok()) {
    TACTUS_ASSIGN_OR_RETURN(const std::string moved,
                            MoveCatalog(files, folder));
    done = absl::StrCat(
        moved.empty() ? "there was none"
                      : absl::StrCat("what was there is in ", moved),
        "; a new one begins without records, and no blob has a name");
  }
  TACTUS_ASSIGN_OR_RETURN(const auto catalog, OpenSqliteCatalog(path));
  TACTUS_RETURN_IF_ERROR(MarkDirectory(files, folder, *catalog));
  return done;
}

}  // namespace tactus::internal
