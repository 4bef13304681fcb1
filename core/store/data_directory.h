// File: data_directory.h
//
// DataDirectory: the folder in which a server keeps its data.
//
//   catalog.db   the catalogue (catalog.h)
//   blobs/       trials and bundles by their SHA-256 (blob_store.h)
//   uploads/     bytes of uploads that are not finished
//   jobs/        one folder for each job that has not ended
//   lock         held by the process that uses the folder
//   marker       says that the folder was used (directory_identity.h)
//   reserve      room for deletions on a full disk (disk_reserve.h)
//   lost+found/  what a repair found that nothing names
//
//   TACTUS_ASSIGN_OR_RETURN(auto data,
//                           DataDirectory::Open(PosixFileSystem(), "/data"));
//   BlobStore& blobs = data->blobs();
//
// Thread-safe. `files` must outlive it.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/blob_store.h"
#include "core/store/catalog.h"
#include "core/store/directory_lock.h"
#include "core/store/disk_reserve.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class DataDirectory {
 public:
  // Creates what does not exist. IO if another process uses the folder;
  // DATA_LOST if the catalogue is damaged, or is not that of the folder.
  // `vfs`: as OpenSqliteCatalog.
  static absl::StatusOr<std::unique_ptr<DataDirectory>> Open(
      FileSystem& files, const std::string& folder,
      const std::string& vfs = "");
  ~DataDirectory();

  FileSystem& files() const { return files_; }
  Catalog& catalog() const { return *catalog_; }
  BlobStore& blobs() const { return *blobs_; }
  DiskReserve& reserve() const { return *reserve_; }
  // True if the catalogue is older than the folder: what was stored since is in
  // no record.
  bool catalog_is_older() const { return catalog_is_older_; }
  const std::string& folder() const { return folder_; }
  std::string BlobFolder() const;
  std::string UploadFolder() const;
  // `id`: the part of the upload's name behind the slash.
  std::string UploadPath(absl::string_view id) const;
  std::string JobFolder() const;
  std::string JobPath(absl::string_view id) const;

 private:
  DataDirectory(FileSystem& files, std::string folder)
      : files_(files), folder_(std::move(folder)) {}
  absl::Status OpenParts(const std::string& vfs);

  FileSystem& files_;
  const std::string folder_;
  std::unique_ptr<DirectoryLock> lock_;
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<DiskReserve> reserve_;
  bool catalog_is_older_ = false;
};

}  // namespace tactus::internal
