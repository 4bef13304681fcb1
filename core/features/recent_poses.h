// File: recent_poses.h
//
// RecentPoses: the poses of the last 0.2 s, and how wrong the newest of them
// probably is. One pose is as wrong as the robot's encoders; many together are
// better, also while the link moves.
//
//   RecentPoses poses(/*sample_rate_hz=*/100);
//   poses.Add(&pose, /*missing_before=*/0);
//   const double error_m = poses.NewestError(place, direction);
//
// Memory is constant: 20 poses, at least 0.01 s apart except for the newest
// (pose_spacing.h). Nothing allocates. Not thread-safe; one per stream.
#pragma once

#include <array>
#include <cstdint>

#include "Eigen/Core"
#include "core/skin/frame.h"
#include "core/skin/pose_spacing.h"

namespace tactus::internal {

class RecentPoses {
 public:
  static constexpr int kMaxPoses = 20;

  // `sample_rate_hz` must be above 0.
  explicit RecentPoses(double sample_rate_hz);

  // Forgets all poses.
  void Reset();

  // Takes the next frame, with its pose or null. `missing_before` frames were
  // lost directly before it.
  void Add(const Pose* pose, uint64_t missing_before);

  // Estimates how far the newest pose puts a place of the link beyond where it
  // was, along a direction in the world (unit length), in metres. 0 if there
  // are less than two poses.
  //
  // The place's coordinate along the direction is estimated by the mean over
  // all poses; by straight lines (least squares) over all poses, their newer
  // half and their newest quarter, each of at least 4; and by the newest pose
  // alone. Taken is the first of these with which all later ones agree, because
  // earlier ones have less noise and later ones follow a link that speeds up or
  // stops (O. V. Lepski, "On a problem of adaptive estimation in Gaussian white
  // noise", 1990). Two agree if they differ by at most three standard
  // deviations. The noise of a pose is estimated from second differences.
  double NewestError(const Eigen::Vector3d& link_position,
                     const Eigen::Vector3d& direction) const;

 private:
  struct Entry {
    uint64_t frame = 0;
    Pose pose;
  };

  // The entry `back` entries before the newest.
  const Entry& At(int back) const {
    return entries_[(newest_ + kMaxPoses - back) % kMaxPoses];
  }

  PoseSpacing spacing_;
  std::array<Entry, kMaxPoses> entries_;
  int count_ = 0;
  int newest_ = 0;
  // False if the next pose replaces the newest.
  bool newest_is_kept_ = false;
};

}  // namespace tactus::internal
