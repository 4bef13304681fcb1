// File: recorded_frames.h
//
// The numbers of a recording as taxel frames of a skin: order, baseline, scale
// and sign as a skin.json says.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       RecordedFrames frames,
//       MakeFrames(path, file, skin, /*rate_hz=*/50));
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/files/array_file.h"
#include "core/import/rising_columns.h"
#include "core/import/skin_file.h"

namespace tactus::internal {

struct RecordedFrames {
  TaxelSeries taxels;
  // Seconds; empty if the file does not state them.
  std::vector<double> time;
  // One per frame; empty if the file does not state them.
  std::vector<Pose> poses;
  // Says which columns are what, for people; may be empty.
  std::string found;
  // Those of the taxels that rise in every frame, if no skin.json names them.
  std::vector<RisingColumn> rising;
};

// `file` holds frames x taxels or frames x rows x columns numbers, the three of
// a taxel with three axes one after the other or along a last axis, with time
// and poses as FindFrameColumns() says. Or, if skin.events says so, it is a
// list of events (event_frames.h). Unsigned 16-bit numbers that need no more
// than a scale stay as they are. TRIAL_FILE_INVALID names `path`, the frame and
// the taxel.
absl::StatusOr<RecordedFrames> MakeFrames(const std::string& path,
                                          const ArrayFile& file,
                                          const SkinFile& skin, double rate_hz);

// [frames x 7] numbers x y z qx qy qz qw as poses.
absl::StatusOr<std::vector<Pose>> MakePoses(const std::string& path,
                                            const ArrayFile& file);

}  // namespace tactus::internal
