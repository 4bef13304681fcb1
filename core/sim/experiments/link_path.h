// File: link_path.h
//
// The way of the link in a trial with several contacts: during each it moves
// along the skin's outward normal at the contact, as the simulation says; in
// between, it passes smoothly from the way back to the next way forward.
//
//   LinkPath path(skin.layout, first);
//   path.Follow(last_frame_of_first, /*turn_frames=*/25, second);
//   path.Rest(last_frame_of_second, /*turn_frames=*/50);
//   motion.steps = path.Steps(frames);
//
// Keeps pointers to the contacts. Not thread-safe.
#pragma once

#include <cstddef>
#include <vector>

#include "Eigen/Core"
#include "core/sim/skin/record_contacts.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class LinkPath {
 public:
  // The way of `first` from frame 0 on; its touch is the origin.
  LinkPath(const SkinLayout& layout, const PlacedContact& first);

  // Passes to the way of `next` within `turn_frames` >= 1 after `frame`. Half
  // way through, both ways are at the same place, so the arm goes no detour.
  void Follow(size_t frame, size_t turn_frames, const PlacedContact& next);
  // Comes to rest within `turn_frames` after `frame`.
  void Rest(size_t frame, size_t turn_frames);

  // One for each of the first `frames` frames.
  std::vector<LinkStep> Steps(size_t frames) const;

 private:
  struct Leg {
    // Null: at rest.
    const PlacedContact* contact = nullptr;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    // The turn from the leg before.
    size_t turn_begin = 0;
    size_t turn_frames = 0;

    Eigen::Vector3d PositionAt(size_t frame) const;
  };

  void Add(Leg leg);

  const SkinLayout& layout_;
  std::vector<Leg> legs_;
};

}  // namespace tactus::internal
