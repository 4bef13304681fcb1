// File: blob_cache.h
//
// BlobCache: copies of blobs on a server's own disk, so that it need not read
// them again from a folder that servers share over a network.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto cache, BlobCache::Open(files, "/var/lib/tactus/blob-cache",
//                                   /*max_bytes=*/int64_t{1} << 30));
//   if (auto bytes = cache->Find(sha256, limit)) return *std::move(bytes);
//   TACTUS_ASSIGN_OR_RETURN(std::string bytes, ReadFromAfar(sha256, limit));
//   cache->Keep(sha256, bytes);
//
// Its files never take more than `max_bytes`, drafts included: the blobs that
// were used least recently make room. After a start the order of use is not
// known, and that of the names stands in for it. Nothing is synced: each read
// checks the SHA-256. A copy that a crash or its disk has damaged is removed,
// and counts as missing. No error of this disk becomes an error of a reader.
//
// One process at a time has the folder. Thread-safe. `files` must outlive it.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/directory_lock.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class BlobCache {
 public:
  struct Totals {
    int64_t found = 0;
    int64_t missing = 0;
    // Copies that did not have their SHA-256, or could not be read.
    int64_t damaged = 0;
    int64_t evicted = 0;
    int64_t blobs = 0;
    int64_t bytes = 0;
  };

  // Creates the folder if it does not exist, and takes over the copies in it.
  // IO if another process has it, or it cannot be made.
  static absl::StatusOr<std::unique_ptr<BlobCache>> Open(FileSystem& files,
                                                         std::string folder,
                                                         int64_t max_bytes);

  // The bytes of a blob of at most `limit` bytes, if they are there.
  std::optional<std::string> Find(const std::string& sha256, int64_t limit);
  // Keeps a copy, if there is room. `bytes` must have this SHA-256.
  void Keep(const std::string& sha256, absl::string_view bytes);
  void Remove(const std::string& sha256);

  Totals totals() const;

 private:
  struct Copy {
    int64_t bytes;
    std::list<std::string>::iterator place;
  };

  BlobCache(FileSystem& files, std::string folder, int64_t max_bytes,
            std::unique_ptr<DirectoryLock> lock)
      : files_(files),
        folder_(std::move(folder)),
        max_bytes_(max_bytes),
        lock_(std::move(lock)) {}
  absl::Status TakeOver();
  std::string PathOf(const std::string& sha256) const;
  // Evicts until `bytes` more fit, and counts them; false if they cannot fit.
  bool MakeRoom(int64_t bytes);
  void Add(const std::string& sha256, int64_t bytes);
  // Removes a copy and its file.
  void Drop(std::map<std::string, Copy>::iterator copy);

  FileSystem& files_;
  const std::string folder_;
  const int64_t max_bytes_;
  const std::unique_ptr<DirectoryLock> lock_;

  mutable std::mutex mutex_;
  std::map<std::string, Copy> copies_;
  // The least recently used one first.
  std::list<std::string> order_;
  // Copies and drafts that are being written.
  int64_t bytes_ = 0;
  uint64_t drafts_ = 0;
  Totals totals_;
};

}  // namespace tactus::internal
