// File: frame.h
//
// One skin frame as the pipeline takes it: values in the layout's unit, and the
// pose of the skin's link if the robot sends one.
//
//   FrameView frame{.taxels = taxels, .pose = &pose};
//   pipeline->Step(frame);
//
// Plain data; thread-safe.
#pragma once

#include <cstdint>
#include <span>

#include "Eigen/Core"
#include "Eigen/Geometry"

namespace tactus::internal {

// Pose of the skin's link in the world frame.
struct Pose {
  // Metres.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  // Unit length.
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

// Views one frame; owns nothing.
struct FrameView {
  // rows x columns x axes values, row-major, in the layout's unit; finite, and
  // >= 0 unless the layout has signed_values.
  std::span<const float> taxels;
  // Null if the robot sends no poses.
  const Pose* pose = nullptr;
  // Frames lost directly before this one.
  uint64_t missing_before = 0;
};

}  // namespace tactus::internal
