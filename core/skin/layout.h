// File: layout.h
//
// SkinLayout: the shape of one skin patch and the meaning of its numbers. A
// stream sends it once; frames carry values only.
//
//   TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset("cody-forearm"));
//
// Plain data, copyable. Threads may share a layout that no longer changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

enum class TaxelUnit { kNewton, kCounts };
enum class Connectivity { kFour, kEight };

// How contacts are felt that are too light for a single taxel
// (core/light_touch/light_touch.h): by regions of taxels, over a window of
// time, above each taxel's background.
struct LightTouch {
  // Time constant of the mean over frames, s, limits::kMinLightWindowS to
  // kMaxLightWindowS.
  double window_s = 0;
  // Size of a region, at most that of the skin and limits::kMaxLightSide.
  int rows = 0;
  int columns = 0;
  // A contact begins once the mean of some region is onset_threshold or more
  // above its background; it goes on while some mean is at contact_threshold.
  // In the layout's unit, limits::kMinLightThreshold to kMaxTaxelValue, onset
  // >= contact.
  double contact_threshold = 0;
  double onset_threshold = 0;

  bool operator==(const LightTouch&) const = default;
};

struct SkinLayout {
  // Layout class, e.g. "cody-forearm". A model accepts one class.
  std::string name = {};
  int rows = 0;
  int columns = 0;
  // Metres between neighbours, limits::kMinTaxelPitchM to kMaxTaxelPitchM;
  // columns are measured along the circumference when they wrap.
  double row_pitch_m = 0;
  double column_pitch_m = 0;
  // Square metres that one touched taxel stands for, limits::kMinTaxelAreaM2
  // to kMaxTaxelAreaM2.
  double taxel_area_m2 = 0;
  // True if column columns-1 is the neighbour of column 0.
  bool wrap_columns = false;
  TaxelUnit unit = TaxelUnit::kNewton;
  // A taxel >= contact_threshold is in contact; a contact begins once some
  // taxel >= onset_threshold. Both in `unit`, limits::kMinThreshold to
  // kMaxTaxelValue, onset >= contact.
  double contact_threshold = 0;
  double onset_threshold = 0;
  Connectivity connectivity = Connectivity::kEight;
  // One byte per taxel, 0 = ignore; empty = all valid.
  std::vector<uint8_t> mask = {};
  // If set, contact_threshold and onset_threshold apply to what each taxel
  // reads above its background.
  std::optional<LightTouch> light_touch = std::nullopt;
  // Values of a taxel: 1, its load; or 3, along x (across the rows), y (across
  // the columns) and z (out of the skin), of taxel 0 first. core/skin/
  // normal_loads.h makes one load of them.
  int axes = 1;
  // The axis that carries the load, 0 to axes - 1. Without one, the load is the
  // distance of a taxel's values from those of the untouched skin, which are 0.
  // A skin of one axis whose values have no sign needs none.
  std::optional<int> normal_axis = std::nullopt;
  // Values may be below 0.
  bool signed_values = false;
  // Taxels that carry something else than touch, such as a joint's angle:
  // row-major indices, rising, at most limits::kMaxAuxiliaryTaxels. The mask
  // ignores them, so that no contact is felt there.
  std::vector<uint32_t> auxiliary = {};

  int taxels() const { return rows * columns; }
  // Values of a frame: `axes` for each taxel.
  int values() const { return taxels() * axes; }
  // Radius of the cylinder formed by wrapping columns, in metres.
  double CylinderRadius() const;

  bool operator==(const SkinLayout&) const = default;
};

// OK if every field is in range; else INVALID_CONFIG naming the field.
absl::Status Validate(const SkinLayout& layout);

// Adds auxiliary taxels to a valid layout without any, and to its mask.
// INVALID_CONFIG if there are too many, one is not there or given twice, or no
// other taxel is left.
absl::Status AddAuxiliary(std::vector<uint32_t> taxels, SkinLayout& layout);

// Which values of a frame mean something, one byte per value: 0 for those of
// masked taxels, but not of auxiliary ones. Empty if all do.
std::vector<uint8_t> ValueMask(const SkinLayout& layout);

// The first difference between two layouts that changes what a frame means to a
// model, as "contact_threshold 4, not 5" with the value of `layout` first;
// empty if there is none. Masks may differ, because a taxel may break, but not
// in auxiliary taxels. Lengths
// and areas that differ by less than a millionth are equal.
std::string SkinDifference(const SkinLayout& layout, const SkinLayout& other);

// The preset of this name:
// - "cody-forearm": 16 x 24, columns wrap, newtons; thresholds of the paper,
//   Section "Preprocessing and Feature Selection" of the robot experiment.
// - "vitac-12x32": counts.
// - "icub-6x10": six triangles of ten taxels of the iCub's skin, as if flat,
//   one per row; counts (capacitance units).
// Any other name is UNKNOWN_LAYOUT, whose text lists the presets.
absl::StatusOr<SkinLayout> LayoutPreset(absl::string_view name);

}  // namespace tactus::internal
