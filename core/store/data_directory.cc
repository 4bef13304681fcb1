#include "core/store/data_directory.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/copy_mark.h"
#include "core/store/directory_identity.h"
#include "core/store/sqlite_catalog.h"

namespace tactus::internal {

absl::StatusOr<std::unique_ptr<DataDirectory>> DataDirectory::Open(
    FileSystem& files, const std::string& folder, const std::string& vfs) {
  std::unique_ptr<DataDirectory> data(new DataDirectory(files, folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_ASSIGN_OR_RETURN(data->lock_, DirectoryLock::Take(folder));
  TACTUS_ASSIGN_OR_RETURN(const int64_t catalog_bytes,
                          files.Size(CatalogPath(folder)));
  data->reserve_ = std::make_unique<DiskReserve>(
      files, folder + "/reserve", ReserveBytes(folder, catalog_bytes));
  const absl::Status opened =
      data->reserve_->With([&] { return data->OpenParts(vfs); });
  // A directory of release 0.1.0 has no reserve. Without a server, datasets
  // cannot be deleted.
  if (ReasonOf(opened) == "STORAGE_FULL") {
    return StorageFull(folder,
                       "its disk is full, and a start needs some room. Remove "
                       "other files from this disk, or make it larger");
  }
  TACTUS_RETURN_IF_ERROR(opened);
  data->reserve_->Renew();
  return data;
}

absl::Status DataDirectory::OpenParts(const std::string& vfs) {
  own_catalog_.reset();
  TACTUS_RETURN_IF_ERROR(CheckCatalogFile(files_, folder_));
  auto catalog = OpenSqliteCatalog(CatalogPath(folder_), vfs);
  absl::Status status = catalog.status();
  if (status.ok()) status = (*catalog)->Check();
  TACTUS_RETURN_IF_ERROR(WithRestoreAdvice(folder_, status));
  own_catalog_ = *std::move(catalog);
  own_locks_ = std::make_unique<LocalLocks>();
  catalog_ = own_catalog_.get();
  locks_ = own_locks_.get();
  TACTUS_RETURN_IF_ERROR(RefuseUnfinishedCopy(*catalog_, folder_));
  TACTUS_RETURN_IF_ERROR(CheckCatalogBelongs(files_, folder_, *catalog_));
  TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(UploadFolder()));
  TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(JobFolder()));
  TACTUS_ASSIGN_OR_RETURN(blobs_, BlobStore::Open(files_, BlobFolder()));
  TACTUS_ASSIGN_OR_RETURN(catalog_is_older_,
                          CatalogIsOlder(files_, folder_, *catalog_));
  return MarkDirectory(files_, folder_, *catalog_);
}

absl::StatusOr<std::unique_ptr<DataDirectory>> DataDirectory::OpenShared(
    FileSystem& files, const std::string& folder, const std::string& name,
    Catalog* catalog, Locks* locks) {
  std::unique_ptr<DataDirectory> data(new DataDirectory(files, folder));
  data->catalog_ = catalog;
  data->locks_ = locks;
  TACTUS_RETURN_IF_ERROR(RefuseUnfinishedCopy(*catalog, folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  if (const absl::Status belongs = CheckCatalogBelongs(files, folder, *catalog);
      absl::IsDataLoss(belongs)) {
    return DataLost(folder,
                    "it is not the folder of this catalogue; give the one that "
                    "the other servers of the catalogue have");
  } else {
    TACTUS_RETURN_IF_ERROR(belongs);
  }
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(data->UploadFolder()));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(data->JobFolder()));
  TACTUS_ASSIGN_OR_RETURN(
      data->blobs_, BlobStore::OpenShared(files, data->BlobFolder(), name));
  // The catalogue needs no room there, so deletions work without a reserve.
  data->reserve_ = std::make_unique<DiskReserve>(files, folder + "/reserve", 0);
  TACTUS_ASSIGN_OR_RETURN(data->catalog_is_older_,
                          CatalogIsOlder(files, folder, *catalog));
  TACTUS_RETURN_IF_ERROR(MarkDirectory(files, folder, *catalog));
  return data;
}

DataDirectory::~DataDirectory() {
  // Before the lock.
  own_catalog_.reset();
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

}  // namespace tactus::internal
