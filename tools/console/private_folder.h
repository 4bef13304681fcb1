// File: private_folder.h
//
// PrivateFolder: a folder that nobody else can look into, for as long as the
// object lives, and no longer than the process.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto folder,
//                           PrivateFolder::Make("/var/tmp"));
//   std::ofstream(folder->path() + "/list") << names;
//
// A process that crashes leaves its folder behind; the next one that makes one
// in the same place removes it. Thread-safe.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace tactus::internal::console {

class PrivateFolder {
 public:
  // Makes a folder with a new name in `parent`, of mode 0700. IO.
  static absl::StatusOr<std::unique_ptr<PrivateFolder>> Make(
      const std::string& parent);
  // Removes the folder and what is in it.
  ~PrivateFolder();

  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  PrivateFolder(std::string path, int lock)
      : path_(std::move(path)), lock_(lock) {}

  const std::string path_;
  // The folder itself, locked: whoever can lock it knows that it is forgotten.
  const int lock_;
};

}  // namespace tactus::internal::console
