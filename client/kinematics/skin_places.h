// File: skin_places.h
//
// SkinPlaces: where a point of the skin is, on its link and in the world. It
// turns the centroid in an answer into a point in space.
//
//   const SkinPlaces places(info.layout);
//   const v1::ContactPatch& patch = answer.contacts(0).patch();
//   const std::optional<Pose> pose = poses.PoseAt(answer.capture_time_ns());
//   if (pose) {
//     const Eigen::Vector3d place = places.InWorld(
//         {patch.centroid_row(), patch.centroid_column()}, *pose);
//   }
//
// The places come from the layout (core/skin/geometry.h: flat, or a cylinder),
// or from the position of each taxel. A contact across the seam of a cylinder
// needs no care: the server counts its columns along the contact, so that its
// centroid is at the seam and not on the opposite side.
//
// Positions are metres. Plain data after construction; threads may share it.
#pragma once

#include <optional>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "core/skin/frame.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

class SkinPlaces {
 public:
  // `layout` must be valid.
  explicit SkinPlaces(const SkinLayout& layout) : layout_(layout) {}

  // `cells` has the position on the link of each cell of the layout, row-major;
  // nothing for a cell without a taxel. icub::CellPositions returns them for
  // skins with a position file. INVALID_CONFIG if there is not one entry per
  // cell, or no position, or one that is not finite.
  static absl::StatusOr<SkinPlaces> FromPositions(
      const SkinLayout& layout,
      std::vector<std::optional<Eigen::Vector3d>> cells);

  // In the frame of the link. Between cells of known positions the place is
  // interpolated (bilinearly, over those of the four cells around that have a
  // position; if none has, the nearest cell that has one).
  Eigen::Vector3d OnLink(const SkinPoint& point) const;

  // In the world, if the link has this pose.
  Eigen::Vector3d InWorld(const SkinPoint& point, const Pose& pose) const {
    return pose.position + pose.orientation * OnLink(point);
  }

 private:
  Eigen::Vector3d NearestCell(const SkinPoint& point) const;

  SkinLayout layout_;
  // Empty: the layout's geometry holds.
  std::vector<std::optional<Eigen::Vector3d>> cells_;
};

}  // namespace tactus::internal::client
