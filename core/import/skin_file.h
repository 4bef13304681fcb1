// File: skin_file.h
//
// SkinFile: a `skin.json`, which says how a folder of recordings is imported:
// the skin, the meaning of its numbers, and the names of the table's columns
// (docs/formats.md, "Your own recordings").
//
//   TACTUS_ASSIGN_OR_RETURN(SkinFile skin, ReadSkinFile("mine/skin.json"));
//   skin.layout.rows;
//
// Plain data; thread-safe.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/files/array_file.h"
#include "core/skin/layout.h"

namespace tactus::internal {

// What becomes of values below zero.
enum class NegativeValues { kRefused, kZero, kAbsolute };

// How events become frames: the number of events of a frame, their sum since
// the beginning, or the value of the last one.
enum class EventRule { kNone, kCount, kSum, kHold };

// What becomes of a frame with the time of the frame before it.
enum class RepeatedTimes { kRefused, kDropped };

struct SkinFile {
  // Without thresholds (0) if they come from idle frames.
  SkinLayout layout;
  bool thresholds_from_idle = false;
  // The skin is untouched in this many first frames of each trial.
  int idle_frames = 0;
  // Or: this fraction of the taxels, those with the least load, is untouched
  // in each trial.
  double idle_taxels = 0;
  // 0: the table has a column.
  double sample_rate_hz = 0;
  // A value in `unit` is scale * (number - baseline), or with `pressing_lowers`
  // scale * (baseline - number).
  double scale = 1;
  double baseline = 0;
  // The baseline of each taxel is its mean over the idle frames of its trial.
  bool baseline_from_idle = false;
  bool pressing_lowers = false;
  NegativeValues negative_values = NegativeValues::kRefused;
  EventRule events = EventRule::kNone;
  // Events with a value above 0 make one plane of taxels and the others a
  // second one below it, with a masked row between them. The layout has both
  // planes; files number the taxels of one.
  bool two_planes = false;
  // Seconds per unit of the files' times.
  double time_scale_s = 1;
  // What the frames' files do not say of themselves.
  ArrayFormat format;
  // The column of the times, by name or by place from 0; "" means none. Absent:
  // a column `time`.
  std::optional<std::string> time_column;
  // The columns of the taxels in order, each a name, a place from 0, or a range
  // of either, "c1..c16". Empty: all others.
  std::vector<std::string> taxel_columns;
  // The columns of what the robot measures beside touch, as above: auxiliary
  // taxels, behind the others. Their numbers stay as they are.
  std::vector<std::string> auxiliary_columns;
  // Only auxiliary taxels may read below 0.
  bool unsigned_touch = false;
  RepeatedTimes repeated_times = RepeatedTimes::kRefused;
  // Dataset of HDF5 and .npz files and bags, where the table names none.
  std::string dataset;
  // What bags give (ros_bag.h); the topic of the frames is `dataset`.
  std::string bag_values = "normal";
  std::string pose_topic;
  // The table of trials.
  std::string table = "trials.csv";
  // Takes fields of a trial from the names of files (file_names.h); empty:
  // none.
  std::string file_names;
  // What the fields of a trial are made of, e.g. {"label", "{material}"}.
  std::map<std::string, std::string> fields;
  // For each number of a frame its taxel, row-major; empty: in order.
  std::vector<int> cells;
  // `cells` come from a file of positions, so taxels have no row and column.
  bool placed = false;

  // Taxels of one frame in the files.
  size_t frame_taxels() const {
    return cells.empty() ? static_cast<size_t>(layout.taxels()) : cells.size();
  }
  // Taxels and rows that events name: those of one plane.
  size_t event_taxels() const {
    return two_planes ? frame_taxels() / 2 : frame_taxels();
  }
  int event_rows() const {
    return two_planes ? (layout.rows - 1) / 2 : layout.rows;
  }
  // Numbers of one frame in the files: those of all axes of a taxel together.
  size_t frame_size() const { return frame_taxels() * layout.axes; }
  // For a number of a frame in the files its place in a frame of the skin.
  size_t PlaceOf(size_t number) const {
    if (cells.empty()) return number;
    return static_cast<size_t>(cells[number / layout.axes]) * layout.axes +
           number % layout.axes;
  }
};

// The fields of a trial that a table may have.
const std::vector<absl::string_view>& TableFields();

// IO if the file, or the one with the positions of taxels, cannot be read;
// TRIAL_FILE_INVALID with the file and the field for anything else.
absl::StatusOr<SkinFile> ReadSkinFile(const std::string& path);

}  // namespace tactus::internal
