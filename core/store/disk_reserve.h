// File: disk_reserve.h
//
// DiskReserve: room on a disk that is kept for what must work when the disk is
// full: a start, and deletions. A file holds it.
//
//   DiskReserve reserve(files, "/data/reserve", 32 << 20);
//   reserve.Renew();
//   TACTUS_RETURN_IF_ERROR(reserve.Check());     // before writing much
//   return reserve.With([&] { return Delete(); });
//
// Thread-safe. `files` must outlive it.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class DiskReserve {
 public:
  DiskReserve(FileSystem& files, std::string path, int64_t bytes)
      : files_(files), path_(std::move(path)), bytes_(bytes) {}

  // Takes the room, or as much of it as there is.
  void Renew();

  // Runs `work`. If that fails because the disk is full, gives the room back,
  // runs `work` once more, and takes the room again. `work` must be all or
  // nothing.
  absl::Status With(absl::FunctionRef<absl::Status()> work);

  // STORAGE_FULL, with what to do, while the room is not complete, or almost
  // nothing is free beside it: what is written now would take the room of the
  // next deletion. Tries to complete it.
  absl::Status Check();

 private:
  // With the lock.
  void Take();

  FileSystem& files_;
  const std::string path_;
  const int64_t bytes_;
  std::mutex mutex_;
  bool full_disk_ = false;
};

// The bytes to reserve for a data directory: enough to delete all that a
// catalogue names, and at most a sixteenth of a small disk.
int64_t ReserveBytes(const std::string& folder, int64_t catalog_bytes);

}  // namespace tactus::internal
