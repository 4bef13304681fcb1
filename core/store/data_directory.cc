#include "core/store/data_directory.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/store/sqlite_catalog.h"

namespace tactus {
absl::StatusOr<std::unique_ptr<DataDirectory>> DataDirectory::Open(
    FileSystem& files, const std::string& folder, const std::string& vfs) {
  std::unique_ptr<DataDirectory> data(new DataDirectory(files, folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_ASSIGN_OR_RETURN(data->lock_, DirectoryLock::Take(folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(data->UploadFolder()));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(data->JobFolder()));
  TACTUS_ASSIGN_OR_RETURN(data->blobs_,
                          BlobStore::Open(files, data->BlobFolder()));
  TACTUS_ASSIGN_OR_RETURN(data->catalog_,
                          OpenSqliteCatalog(folder + "/catalog.db", vfs));
  TACTUS_RETURN_IF_ERROR(data->catalog_->Check());
  TACTUS_RETURN_IF_ERROR(files.SyncDirectory(folder));
  return data;
}

DataDirectory::~DataDirectory() {
  // Before the lock.
  catalog_.reset();
}

std::string DataDirectory::BlobFolder() const { return folder_ + "/blobs"; }
std::string DataDirectory::UploadFolder() const { return folder_ + "/uploads"; }
std::string DataDirectory::UploadPath(absl::string_view id) const {
  return absl::StrCat(UploadFolder(), "/", id);
}
std::string DataDirectory::JobFolder() const { return folder_ + "/jobs"; }
std::string DataDirectory::JobPath(absl::string_view id) const {
  return absl::StrCat(JobFolder(), "/", id);
}

}  // namespace tactus
