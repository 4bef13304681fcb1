#include "core/store/directory_to_copy.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/directory_identity.h"
#include "core/store/sqlite_catalog.h"

namespace tactus::internal {

absl::StatusOr<std::unique_ptr<DirectoryToCopy>> OpenDirectoryToCopy(
    FileSystem& files, const std::string& folder) {
  const std::string path = CatalogPath(folder);
  TACTUS_RETURN_IF_ERROR(CheckCatalogFile(files, folder));
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files.Size(path));
  if (size < 0) {
    return IoError(path,
                   "does not exist. Give the folder that tactusd got as "
                   "--data-dir");
  }
  TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take(folder));
  const auto version = CatalogVersionOf(path);
  TACTUS_RETURN_IF_ERROR(WithRestoreAdvice(folder, version.status()));
  if (*version != kCatalogVersion) {
    return IoError(
        path, absl::StrCat("has version ", *version, ", and this program ",
                           kCatalogVersion,
                           ". Use the trainctl of the server's release; for an "
                           "older version, start the server once"));
  }
  auto catalog = OpenSqliteCatalog(path);
  TACTUS_RETURN_IF_ERROR(WithRestoreAdvice(folder, catalog.status()));
  return std::make_unique<DirectoryToCopy>(folder, std::move(lock),
                                           *std::move(catalog));
}

absl::StatusOr<std::unique_ptr<DirectoryToCopy>> MakeDirectoryToCopy(
    FileSystem& files, const std::string& folder, const std::string& vfs) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take(folder));
  TACTUS_RETURN_IF_ERROR(CheckCatalogFile(files, folder));
  auto catalog = OpenSqliteCatalog(CatalogPath(folder), vfs);
  TACTUS_RETURN_IF_ERROR(WithRestoreAdvice(folder, catalog.status()));
  TACTUS_RETURN_IF_ERROR(files.SyncDirectory(folder));
  return std::make_unique<DirectoryToCopy>(folder, std::move(lock),
                                           *std::move(catalog));
}

}  // namespace tactus::internal
