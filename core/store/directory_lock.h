// File: directory_lock.h
//
// DirectoryLock: a data directory belongs to one process at a time.
//
//   TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take("/data"));
//
// Held until it is destroyed, or the process ends. Thread-safe: it does not
// change.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace tactus {

class DirectoryLock {
 public:
  // IO if another process holds it, or if the file "lock" in `folder` cannot be
  // opened or made.
  static absl::StatusOr<std::unique_ptr<DirectoryLock>> Take(
      const std::string& folder);
  ~DirectoryLock();

  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  explicit DirectoryLock(int fd) : fd_(fd) {}

  const int fd_;
};

}  // namespace tactus
