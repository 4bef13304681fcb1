// File: skin.h
//
// Skin and Frame: what a robot's skin is like, and one reading of it.
//
//   Skin forearm = {.name = "cody-forearm", .scale = 0.001};  // millinewtons
//
//   Skin palm = {.name = "my-palm",
//                .rows = 8,
//                .columns = 8,
//                .row_pitch_m = 0.005,
//                .column_pitch_m = 0.005,
//                .taxel_area_m2 = 25e-6,
//                .contact_threshold = 0.01,
//                .onset_threshold = 0.02};
//
//   Frame frame;
//   frame.values.assign(palm.rows * palm.columns, 0.0F);
//
// Plain data, copyable.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tactus {

enum class SkinUnit { kNewton, kCounts };

// How values travel to a server. The answers do not depend on it.
enum class TaxelEncoding {
  // Two bytes a value: whole numbers from 0 to 65,535.
  kUint16,
  // Four bytes a value.
  kFloat32,
  // Two bytes a value: whole numbers from -32,768 to 32,767, for skins with
  // signed values.
  kInt16,
};

// How contacts are felt that are too light for a single taxel: by the mean of a
// region of taxels, over a window of time, above its background.
struct SkinLightTouch {
  // Time constant of the mean over frames in seconds, 0.01 to 1.
  double window_s = 0;
  // Size of a region, 1 to 16, and at most that of the skin.
  int rows = 0;
  int columns = 0;
  // A contact goes on while the mean of some region is at least the first of
  // these, and begins at the second, in the skin's unit.
  double contact_threshold = 0;
  double onset_threshold = 0;
};

// Fixed for a whole stream. With rows and columns 0, `name` is that of a preset
// ("cody-forearm", "vitac-12x32", "icub-6x10"), whose shape and unit are used;
// thresholds, mask and light touch that are given replace those of the preset.
struct Skin {
  // Layout class. A model answers for skins of one class.
  std::string name = {};
  int rows = 0;
  int columns = 0;
  // Metres between neighbours; columns are measured along the circumference if
  // they wrap.
  double row_pitch_m = 0;
  double column_pitch_m = 0;
  // Square metres that one taxel stands for.
  double taxel_area_m2 = 0;
  // True if the last column is a neighbour of the first: a cylinder.
  bool wrap_columns = false;
  SkinUnit unit = SkinUnit::kNewton;
  // A taxel is touched if it is at least the first of these; a contact begins
  // once some taxel is at least the second. In `unit`.
  double contact_threshold = 0;
  double onset_threshold = 0;
  // Row-major indices of taxels to ignore.
  std::vector<int> masked_taxels = {};
  // Taxels that touch at a corner only are no neighbours.
  bool only_side_neighbours = false;
  std::optional<SkinLightTouch> light_touch = std::nullopt;
  // Values of a taxel: 1, its load; or 3, along x (across the rows), y (across
  // the columns) and z (out of the skin), of the first taxel first.
  int axes = 1;
  // The axis that carries the load. Without one, the load is the distance of a
  // taxel's values from 0, which untouched skin reads, as for magnetometers.
  std::optional<int> normal_axis = std::nullopt;
  // Values may be below 0.
  bool signed_values = false;
  // Row-major indices of taxels that carry something else than touch, such as
  // the angle of a joint: inputs of models that were trained with them. If they
  // may be below 0 and the others may not, set signed_values, and normal_axis
  // to 0.
  std::vector<int> auxiliary_taxels = {};

  TaxelEncoding encoding = TaxelEncoding::kUint16;
  // Frame::values times this is in `unit`; above 0.
  double scale = 1;
  // Frames per second.
  double sample_rate_hz = 100;
  // Every frame has a pose of the link that carries the skin.
  bool with_poses = false;
};

// The pose of a link in the world: metres, and a quaternion of unit length.
struct LinkPose {
  double x = 0;
  double y = 0;
  double z = 0;
  double qx = 0;
  double qy = 0;
  double qz = 0;
  double qw = 1;
};

// One reading. Keep it and write to it again: it keeps its memory.
struct Frame {
  // When it was read, on the robot's clock; rises from frame to frame.
  int64_t capture_time_ns = 0;
  // Frames that the skin lost directly before this one.
  uint64_t missing_before = 0;
  // [rows x columns x axes], row-major, at least 0 unless the skin has signed
  // values; times Skin::scale in its unit.
  std::vector<float> values = {};
  // Used only if the skin has poses.
  LinkPose pose = {};
};

}  // namespace tactus
