// File: trial.h
//
// One recorded or simulated contact, or several (`touches`), labelled: time,
// and the three signals and/or the taxel frames they come from. Mirrors a group
// of the trial file (docs/formats.md).
//
//   std::vector<float> frame(trial.taxels.frame_size());
//   for (size_t t = 0; t < trial.taxels.frames(); ++t) {
//     trial.taxels.Decode(t, frame.data());
//   }
//
// Plain data; owns its arrays. Safe to read from several threads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/data/touch.h"
#include "core/features/feature.h"
#include "core/skin/frame.h"
#include "core/skin/layout.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal {

// Taxel frames as stored: row-major, rows x columns x axes a frame.
struct TaxelSeries {
  int rows = 0;
  int columns = 0;
  // 1 or 3, as SkinLayout::axes.
  int axes = 1;
  // One of the three is filled. Integers times `scale` give the unit; f32
  // values are in the unit already and have scale 1.
  std::vector<uint16_t> u16;
  std::vector<int16_t> i16;
  std::vector<float> f32;
  double scale = 1;

  size_t frames() const;
  // Values of a frame.
  size_t frame_size() const {
    return static_cast<size_t>(rows) * columns * axes;
  }
  bool empty() const { return u16.empty() && i16.empty() && f32.empty(); }
  // How the values are stored.
  v1::TaxelType type() const;
  // {frames, rows, columns}, and the axes if there are several.
  std::vector<size_t> shape() const;
  // Takes rows, columns and axes from a skin.
  void SetShape(const SkinLayout& skin);
  // Writes frame `index` in the unit to `out`, which has frame_size() places:
  // integers are multiplied in double and rounded once.
  void Decode(size_t index, float* out) const;
};

struct Trial {
  // "000000"; the group's name in the file (trial_id.h).
  std::string id;
  // Name of the recording that it was made from, "pad_17.csv"; empty if
  // unknown.
  std::string source;
  // Seconds, increasing.
  std::vector<double> time;
  // Empty, or one per time: force (N), area (m^2), motion (m).
  std::vector<FeatureVector> signals;
  // Empty, or one frame per time.
  TaxelSeries taxels;
  // Empty, or one per time.
  std::vector<Pose> poses;
  // Empty, or one per time: how far the object has moved, m; truth, never an
  // input.
  std::vector<double> object_motion;

  // Empty: the whole trial has one contact, of `label`. Else its contacts in
  // the order of their beginnings, at most limits::kMaxTouchesPerTrial. What
  // the trial says of its object is then said of the first of them, and
  // `object_motion` is empty.
  std::vector<Touch> touches;

  // "HU", "HM", "SU", "SM", or any other class name.
  std::string label;
  // Robot condition, e.g. "k543-v0.005"; folds of leave-one-condition-out.
  std::string condition;
  std::string object;
  // Folds of leave-one-material-out.
  std::string material;
  // Stiffness of the object, N/m; 0 if unknown.
  double stiffness = 0;
  // Speed of the arm's equilibrium point, m/s; 0 if unknown.
  double velocity = 0;
  double sample_rate_hz = 100;
  // Layout class of `taxels`, e.g. "cody-forearm"; empty without taxels.
  std::string layout;
  // Unit of the force signal and of the taxels: "newton" or "counts".
  std::string unit = "newton";
  // The whole skin of `taxels`; its name is `layout`, its unit `unit`. Nothing
  // without taxels, and in files that name their layout only (trial_layout.h).
  std::optional<SkinLayout> skin;
};

// "newton" or "counts", as Trial::unit.
std::string UnitText(TaxelUnit unit);

// Sets `layout`, `unit` and `skin` of the trial.
void SetSkin(const SkinLayout& skin, Trial& trial);

// OK if all parts of `trial` have one length and every number is finite and
// in range; else TRIAL_FILE_INVALID, which names `path`, the trial and the
// part.
absl::Status Validate(const Trial& trial, absl::string_view path);

}  // namespace tactus::internal
