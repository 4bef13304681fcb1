// File: lost_and_found.h
//
// LostAndFound: the folder "lost+found" of a data directory, to which what no
// record names is moved. Nothing is deleted there; people do that by hand.
//
//   LostAndFound lost(files, "/data");
//   TACTUS_RETURN_IF_ERROR(lost.Take("blobs/ab/abcd"));
//   Print(lost.folder());  // "/data/lost+found/3", with "blobs/ab/abcd" in it
//
// Not thread-safe. `files` must outlive it.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class LostAndFound {
 public:
  LostAndFound(FileSystem& files, const std::string& data_folder)
      : files_(files), data_folder_(data_folder) {}

  // Moves a file or folder, named from the data directory on.
  absl::Status Take(const std::string& path);

  // Where this object put things; empty if nothing was taken. Each object has
  // another folder.
  const std::string& folder() const { return folder_; }

 private:
  absl::Status MakeFolder();

  FileSystem& files_;
  const std::string data_folder_;
  std::string folder_;
};

}  // namespace tactus::internal
