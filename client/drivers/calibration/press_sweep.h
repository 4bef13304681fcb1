// File: press_sweep.h
//
// PressSweep: taxels that never reach their onset threshold while somebody
// presses every place of the skin.
//
//   PressSweep sweep(idle, calibration);
//   while (Pressing()) sweep.Add(frame);
//   for (const int taxel : sweep.Unfelt()) Mask(taxel);
//
// Add allocates nothing. Not thread-safe.
#pragma once

#include <vector>

#include "client/drivers/calibration/axis_loads.h"
#include "client/drivers/calibration/calibration.h"
#include "client/drivers/calibration/idle_frames.h"
#include "client/stream/skin_frame.h"

namespace tactus::internal::client {

class PressSweep {
 public:
  // `calibration` was made of `idle`, which outlives the sweep.
  PressSweep(const IdleFrames& idle, const Calibration& calibration);

  void Add(const SkinFrame& frame);

  // Row-major indices, rising, without masked taxels.
  std::vector<int> Unfelt() const;
  // Some taxel that is not masked had two values, at rest or since.
  bool changed() const { return changed_; }

 private:
  void Compare(std::span<const float> values);

  const IdleFrames& idle_;
  const AxisLoads loads_;
  const std::vector<double> baseline_;
  const std::vector<double> onset_threshold_;
  std::vector<float> values_;
  std::vector<double> readings_;
  // The largest load of each taxel.
  std::vector<double> largest_;
  bool changed_ = false;
};

}  // namespace tactus::internal::client
