// File: event_frames.h
//
// Lists of events, as event-driven skins record them, as frames at a fixed
// rate. An event has a time, a taxel and perhaps a value (a polarity, say).
// With SkinFile::two_planes, events with a value above 0 count in the first
// plane, and all others in the second one.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const EventFrames frames,
//       MakeEventFrames(path, file, skin, /*rate_hz=*/100));
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/files/array_file.h"
#include "core/import/skin_file.h"

namespace tactus::internal {

struct EventFrames {
  // Seconds; frame k holds the events from time[k] on, for 1 / rate_hz.
  std::vector<double> time;
  // [frames x frame_size] numbers, as skin.events says; of two planes those of
  // the first before those of the second, and each event counts as 1.
  std::vector<double> numbers;
};

// `file` holds a row per event. Its columns are those that its header names
// (time, taxel, row, column, value), else time, taxel or time, taxel, value or
// time, row, column, value. Times do not decrease. TRIAL_FILE_INVALID names
// `path` and the event.
absl::StatusOr<EventFrames> MakeEventFrames(const std::string& path,
                                            const ArrayFile& file,
                                            const SkinFile& skin,
                                            double rate_hz);

}  // namespace tactus::internal
