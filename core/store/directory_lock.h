// File: directory_lock.h
//
// DirectoryLock: a data directory belongs to one process at a time.
//
//   TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take("/data"));
//
// Held until it is destroyed, or the process ends; forked children do not hold
// it. Thread-safe: it does not change.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace tactus::internal {

class DirectoryLock {
 public:
  // Device and number of a file.
  using FileId = std::pair<dev_t, ino_t>;

  // IO if it is held, by another process or by this one, or if the file
  // "lock" in `folder` cannot be opened or made.
  static absl::StatusOr<std::unique_ptr<DirectoryLock>> Take(
      const std::string& folder);
  // True if `status`, of Take, says that it is held.
  static bool IsInUse(const absl::Status& status);
  ~DirectoryLock();

  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  DirectoryLock(int fd, FileId file) : fd_(fd), file_(file) {}

  const int fd_;
  const FileId file_;
};

}  // namespace tactus::internal
