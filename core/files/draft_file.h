// File: draft_file.h
//
// DraftFile: a file that is written beside its target and takes the target's
// name once it is complete and on disk, so that a reader never sees half a
// file, and a crash or a full disk leaves the target as it was.
//
//   TACTUS_ASSIGN_OR_RETURN(DraftFile draft,
//   DraftFile::Create("model.tactus"));
//   std::ofstream(draft.path()) << bytes;
//   TACTUS_RETURN_IF_ERROR(draft.Publish());
//
// Owns the draft and removes it unless Publish() succeeds. Not thread-safe;
// several drafts of one target may exist at once, in one process or in many.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

class DraftFile {
 public:
  // Creates an empty file with a new name in the folder of `target`. IO if
  // that fails, or if `target` exists and is no regular file.
  static absl::StatusOr<DraftFile> Create(const std::string& target);
  DraftFile(DraftFile&& other) noexcept;
  DraftFile& operator=(DraftFile&& other) noexcept;
  ~DraftFile();

  // Valid until Publish() succeeds.
  const std::string& path() const { return path_; }

  // Writes the draft to the disk, renames it to the target, and writes the
  // folder to the disk. Call it once.
  absl::Status Publish();

 private:
  DraftFile(std::string target, std::string path);

  std::string target_;
  // Empty after Publish().
  std::string path_;
};

// Writes a whole file as a draft and publishes it.
absl::Status WriteFileBytes(const std::string& path, absl::string_view bytes);

}  // namespace tactus::internal
