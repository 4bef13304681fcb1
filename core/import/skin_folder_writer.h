// File: skin_folder_writer.h
//
// SkinFolderWriter: trials as a folder that ImportSkinFolder reads. It has a
// skin.json, a table of trials, and a CSV file of each trial's frames
// (docs/interchange.md, "Trials").
//
//   TACTUS_ASSIGN_OR_RETURN(auto writer, SkinFolderWriter::Create("exported"));
//   for (const Trial& trial : trials) {
//     TACTUS_RETURN_IF_ERROR(writer.Append(trial));
//   }
//   TACTUS_RETURN_IF_ERROR(writer.Close());
//
// An import gives the same id, label, condition, object, material, stiffness,
// velocity, rate, times, poses, skin and values of taxels, bit for bit. Values
// of uint16 and int16 taxels come back as float, those of masked taxels as 0.
// Signals, object_motion and the source are not in the folder.
//
// Owns the text of the table. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class SkinFolderWriter {
 public:
  // Makes the folder if there is none. IO.
  static absl::StatusOr<SkinFolderWriter> Create(const std::string& folder);

  // Writes the frames of a trial, and before the first one the skin.json.
  // TRIAL_FILE_INVALID, naming the trial, if it is not valid, or if the folder
  // cannot hold it: no taxels, several touches, another skin than the first
  // trial's, auxiliary taxels that are not the last rows, names with blanks
  // around them, or more numbers than a text file may have. IO.
  absl::Status Append(const Trial& trial);

  // Writes the table. Without it the folder is not imported. IO.
  absl::Status Close();

 private:
  explicit SkinFolderWriter(std::string folder);

  absl::Status WriteSkin(const Trial& trial, const SkinLayout& skin);

  std::string folder_;
  std::string table_;
  std::optional<SkinLayout> skin_;
  // For each number of a line its place in a frame of the skin.
  std::vector<size_t> places_;
};

}  // namespace tactus::internal
