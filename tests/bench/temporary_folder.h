// File: temporary_folder.h
//
// An empty folder for files of a benchmark, removed with all that is in it.
//
//   TACTUS_ASSIGN_OR_RETURN(const TemporaryFolder folder,
//                           TemporaryFolder::Create());
//   Fit(folder.path() + "/bundle.tactus");
//
// Thread-safe to read.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace tactus::internal::client {

class TemporaryFolder {
 public:
  // Fails with IO.
  static absl::StatusOr<TemporaryFolder> Create();
  TemporaryFolder(TemporaryFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  const std::string& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::string path) : path_(std::move(path)) {}

  // Empty once moved from.
  std::string path_;
};

}  // namespace tactus::internal::client
