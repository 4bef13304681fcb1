// File: frame_columns.h
//
// Which columns of a recording are taxels, time and pose: those that a
// skin.json names, else those that a header names.
//
//   TACTUS_ASSIGN_OR_RETURN(const FrameColumns columns,
//                           FindFrameColumns("a.csv", file, skin));
//   columns.taxels;  // {1, 2, 3}
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/files/array_file.h"
#include "core/import/skin_file.h"

namespace tactus::internal {

struct FrameColumns {
  // Places in a row of the file.
  std::vector<size_t> taxels;
  // One, or none.
  std::vector<size_t> time;
  // Seven, or none.
  std::vector<size_t> pose;
  // The columns of taxels are named by the skin.json.
  bool taxels_are_named = false;
  // Says which columns are what, for people; empty if the file names none.
  std::string found;
};

// `file` holds frames x columns numbers, or frames x rows x columns of the
// skin. Without names in `skin`, the column `time` (in letters of any case) is
// the time, x, y, z, qx, qy, qz and qw are the pose, and all others are taxels.
// TRIAL_FILE_INVALID if there are not as many taxels as the skin has, if a
// column is not there, or if a taxel has a name as times have.
absl::StatusOr<FrameColumns> FindFrameColumns(const std::string& path,
                                              const ArrayFile& file,
                                              const SkinFile& skin);

// The name of a column in a sentence: its name in the header, or its place.
std::string ColumnName(const ArrayFile& file, size_t column);

// The names of the columns of a pose in order.
const std::vector<absl::string_view>& PoseColumns();

}  // namespace tactus::internal
