// File: contact_tracker.h
//
// The paper's three features over time (Section "Preprocessing and Feature
// Selection" of the robot experiment): largest force, area and motion of the
// largest contact region, from the onset of a contact to its release.
//
//   ContactTracker tracker(layout, {.sample_rate_hz = 100});
//   for (const FrameView& frame : frames) {
//     const FrameFeatures& features = tracker.Step(frame);
//     if (tracker.onset()) model.Reset();
//     if (tracker.state() == ContactState::kInContact) {
//       model.Step(features.sample());
//     }
//   }
//
// Step() allocates nothing. Not thread-safe; one per stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "Eigen/Core"
#include "core/features/feature.h"
#include "core/features/segmenter.h"
#include "core/skin/frame.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

// What one frame says about the contact. Outside a contact all is zero but
// `touched` and `region_count`.
struct FrameFeatures {
  // True if some taxel reached contact_threshold.
  bool touched = false;
  // Largest taxel of the largest region, in the layout's unit; 0 if untouched.
  double max_force = 0;
  // Sum over the largest region, in the layout's unit; 0 if untouched.
  double net_force = 0;
  // Size of the largest region, in taxels and square metres; 0 if untouched.
  int area_taxels = 0;
  double area_m2 = 0;
  // Distance of the contact from where it was at onset, in metres: in the world
  // frame if frames come with poses, else of the centroid along the skin.
  double motion_m = 0;
  // Of the whole skin; zero if untouched, or if the tracker leaves it out.
  LoadProfile profile = {};
  // Regions on the skin.
  int region_count = 0;
  // Of the largest region; while touch is lost, where it was last.
  SkinPoint centroid = {};

  ContactSample sample() const {
    return {{max_force, area_m2, motion_m}, net_force, profile};
  }
};

enum class ContactState { kNoContact, kInContact, kReleased };

// Follows one contact after another on one skin.
//
// A contact begins (onset) once some taxel reaches onset_threshold. It goes on
// while any taxel is at or above contact_threshold and through losses of touch
// shorter than release_after_s. Then it is released, and the next onset begins
// a new one, on a later frame.
//
// A loss counts frames from its first untouched one on, with those that went
// missing since the last frame. Frames that go missing between two touched
// ones do not end a contact.
//
// With poses, a region that still covers the place where the contact began has
// grown, not travelled: its motion is that of this place. Centroids move by
// whole taxels as a region grows, poses are a hundred times finer. Once the
// region has left the place, its centroid counts.
//
// While touch is lost, force and area are 0 and the point last touched stays
// fixed to the skin: it moves with the pose, and without poses rests.
class ContactTracker {
 public:
  struct Options {
    // Above 0.
    double sample_rate_hz = 100;
    // Seconds; below 0 a contact is never released.
    double release_after_s = 0.5;
    // Without it, the load profile stays 0, for models that do not look at it.
    bool load_profile = true;
    // What may be skipped; neither changes a bit. A frame without a touched
    // taxel is not segmented; one whose taxels are those of the touched frame
    // before keeps its features, but for the motion, which poses change.
    bool skip_untouched = true;
    bool reuse_unchanged = true;
  };

  // `layout` must be valid.
  ContactTracker(const SkinLayout& layout, const Options& options);

  // Forgets everything seen, as if new.
  void Reset();

  // Takes the next frame of rows x columns taxels. The result lives until the
  // next call.
  const FrameFeatures& Step(const FrameView& frame);

  // The results of the last Step(); kNoContact before the first.
  const FrameFeatures& features() const { return features_; }
  ContactState state() const { return state_; }
  // True on the frame at which a contact began.
  bool onset() const { return onset_; }
  // True on the frame at which a contact ended.
  bool released() const { return released_; }
  // True if the frame's taxels were those of the frame before.
  bool reused() const { return reused_; }

  // How the last frame was segmented.
  const Segmenter& segmenter() const { return segmenter_; }

 private:
  void Begin(const FrameView& frame);
  // True if these are the taxels that features_ were read off.
  bool Unchanged(std::span<const float> taxels) const;
  // Counts a loss of touch; true once it is too long.
  bool Lost(const FrameView& frame);
  // Reads the features off the segmented frame, all but the motion.
  void Measure(const FrameView& frame);
  double Motion(const Pose* pose);

  SkinLayout layout_;
  Segmenter segmenter_;
  float onset_threshold_;
  // Frames of lost touch that release a contact; the largest value is never.
  uint64_t release_frames_;

  ContactState state_ = ContactState::kNoContact;
  bool onset_ = false;
  bool released_ = false;
  bool reused_ = false;
  FrameFeatures features_;
  // The taxels of the last frame, if it was touched and of a contact; empty if
  // frames are never compared.
  std::vector<float> measured_taxels_;
  bool measured_ = false;
  // Frames since the last touched one, up to release_frames_.
  uint64_t lost_frames_ = 0;
  // Of the current contact: where it began, on the skin, in the link's frame
  // and in the world.
  SkinPoint onset_point_;
  Eigen::Vector3d onset_link_position_;
  // The region has left the place where the contact began.
  bool travelled_ = false;
  Eigen::Vector3d onset_position_;
  bool has_pose_ = false;
  // The latest pose of this contact.
  Pose pose_;

  // Empty without the load profile.
  std::vector<double> row_loads_;
  std::vector<double> column_loads_;
};

}  // namespace tactus
