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
// Servers that share a catalogue share a folder with blobs/, uploads/, jobs/
// and lost+found/. The file system must rename atomically, and show to all of
// them what one has synced (NFS, CephFS, Lustre).
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
#include "core/store/locks.h"

namespace tactus::internal {

class DataDirectory {
 public:
  // Creates what does not exist. IO if another process uses the folder;
  // DATA_LOST if the catalogue is damaged, or is not that of the folder.
  // `vfs`: as OpenSqliteCatalog.
  static absl::StatusOr<std::unique_ptr<DataDirectory>> Open(
      FileSystem& files, const std::string& folder,
      const std::string& vfs = "");
  // The folder that the servers of `catalog` share; `name` is this one's among
  // them. Both must outlive it.
  static absl::StatusOr<std::unique_ptr<DataDirectory>> OpenShared(
      FileSystem& files, const std::string& folder, const std::string& name,
      Catalog* catalog, Locks* locks);
  ~DataDirectory();

  FileSystem& files() const { return files_; }
  Catalog& catalog() const { return *catalog_; }
  BlobStore& blobs() const { return *blobs_; }
  DiskReserve& reserve() const { return *reserve_; }
  Locks& locks() const { return *locks_; }
  // True if other servers use it, too.
  bool is_shared() const { return own_catalog_ == nullptr; }
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
  // Null if they are shared.
  std::unique_ptr<Catalog> own_catalog_;
  std::unique_ptr<Locks> own_locks_;
  Catalog* catalog_ = nullptr;
  Locks* locks_ = nullptr;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<DiskReserve> reserve_;
  bool catalog_is_older_ = false;
};

}  // namespace tactus::internal
