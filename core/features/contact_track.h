// File: contact_track.h
//
// ContactTrack: one contact as its region moves over the skin: the paper's
// three features (Section "Preprocessing and Feature Selection" of the robot
// experiment) from its onset to its release.
//
//   ContactTrack track(layout, options);
//   track.Begin(id, frame, touch, poses);
//   Use(track.features());
//   while (track.Step(frame, touched ? &touch : nullptr, poses)) {
//     Use(track.features());
//   }
//
// SkinTracker decides which regions are the contact's. Nothing allocates. Not
// thread-safe; one per contact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "Eigen/Core"
#include "core/base/limits.h"
#include "core/features/feature.h"
#include "core/features/recent_poses.h"
#include "core/features/segmenter.h"
#include "core/skin/frame.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

// The features of one frame of a contact.
struct FrameFeatures {
  // True if the contact touches the skin in this frame.
  bool touched = false;
  // Largest taxel of the contact's largest region, in the layout's unit; 0 if
  // untouched.
  double max_force = 0;
  // Sum over that region, in the layout's unit; 0 if untouched.
  double net_force = 0;
  // Size of that region, in taxels and square metres; 0 if untouched.
  int area_taxels = 0;
  double area_m2 = 0;
  // How far the contact has moved since its onset, in metres. If frames come
  // with poses: along the outward normal that the skin had at onset, in the
  // world; above 0 outwards, i.e. into the object. Else the distance of the
  // centroid from its place at onset, along the skin; never below 0.
  double motion_m = 0;
  // Load profile of the whole skin without the regions of other contacts; zero
  // if untouched, or if it is not computed.
  LoadProfile profile = {};
  // The same taxels; empty if untouched, or if they are not copied. Valid until
  // the next frame.
  std::span<const TaxelLoad> loads = {};
  // Spread of the largest region; zero if untouched, or if it is not measured.
  LoadSpread spread = {};
  // Number of regions on the whole skin.
  int region_count = 0;
  // Centroid of the largest region; while touch is lost, the last one.
  SkinPoint centroid = {};

  ContactSample sample() const {
    return {{max_force, area_m2, motion_m}, net_force, profile, loads, spread};
  }
};

// What a frame shows of one contact. All refer to the caller's memory.
struct ContactTouch {
  // The contact's largest region, and its taxels.
  const Region* region = nullptr;
  std::span<const uint64_t> rows;
  // All taxels that count as the contact's.
  std::span<const uint64_t> all_rows;
  // The loads of the skin's taxels.
  std::span<const float> values;
  // It sums over rows.
  const Segmenter* segmenter = nullptr;
};

class ContactTrack {
 public:
  struct Options {
    double sample_rate_hz = 100;
    // Seconds; below 0 a contact is never released.
    double release_after_s = 0.5;
    bool load_profile = true;
    bool taxel_loads = false;
    bool load_spread = false;
    // A contact also ends before release_after_s when it is clearly over:
    //   - it was strong, and its load is gone for longer than a bounce takes,
    //     0.25 s; it was strong if a taxel read 20 times contact_threshold
    //     within the last second or so;
    //   - the skin has drawn back by 5 mm from where it lost the load.
    // On a skin with light touch the means of a load that is gone fade away;
    // the time in which they do counts as a part of the loss.
    bool release_by_evidence = false;
    // Frames in which these means fade (TouchFinder::fading_frames).
    uint64_t fading_frames = 0;
  };

  // `layout` must be valid.
  ContactTrack(const SkinLayout& layout, const Options& options);

  // Begins contact `id` at a touched frame. `poses` have the frame's pose.
  void Begin(uint64_t id, const FrameView& frame, const ContactTouch& touch,
             const RecentPoses& poses);
  // Takes the next frame, in which the contact touches the skin if `touch` is
  // not null. `poses` have the frame's pose. Returns false if the contact is
  // over: its features are then of no meaning, and the touch may be another
  // contact's.
  bool Step(const FrameView& frame, const ContactTouch* touch,
            const RecentPoses& poses);
  // The same for a frame whose taxels equal those of the frame before, which
  // was touched: only the motion is measured anew.
  void StepUnchanged(const FrameView& frame);
  // Takes a frame in which the contact can't be told from another one.
  void Pause(const FrameView& frame);

  uint64_t id() const { return id_; }
  const FrameFeatures& features() const { return features_; }
  // After its end: all are 0.
  void ForgetFeatures() { features_ = {}; }

 private:
  // Counts a loss of touch; true once it is too long.
  bool Lost(const FrameView& frame, bool touched);
  // Counts a loss of load; true if the contact is clearly over.
  bool IsClearlyOver(const FrameView& frame, const ContactTouch* touch,
                     const RecentPoses& poses);
  void KeepLoad(double largest);
  // True if the skin has drawn back since the load was lost.
  bool HasDrawnBack(const RecentPoses& poses);
  // Measures all features but the motion.
  void Measure(const ContactTouch& touch);
  void MeasureNothing();
  double Motion(const Pose* pose);

  SkinLayout layout_;
  // Frames of lost touch that release a contact, the largest value means never;
  // and those after which a strong contact is over.
  uint64_t release_frames_;
  uint64_t strong_release_frames_;
  const Options options_;
  float contact_threshold_;
  // Factor by which the recent load fades with each frame.
  double fading_;

  uint64_t id_ = 0;
  FrameFeatures features_;
  uint64_t lost_frames_ = 0;
  // Frames since a taxel was last at contact_threshold, and how many of them
  // were touched all the same.
  uint64_t unloaded_frames_ = 0;
  uint64_t faint_frames_ = 0;
  // The largest taxel, as it fades within a second or so.
  double recent_load_ = 0;
  // How far out the skin was, at the most, since the load was lost.
  double farthest_m_ = 0;
  // The place where the contact began: on the skin, in the link's frame and in
  // the world.
  SkinPoint onset_point_;
  Eigen::Vector3d onset_link_position_;
  Eigen::Vector3d onset_position_;
  Eigen::Vector3d onset_normal_;
  // How far onset_position_ probably lies beyond the true place, along
  // onset_normal_.
  double onset_error_ = 0;
  // The region has left the place where the contact began.
  bool travelled_ = false;
  bool has_pose_ = false;
  // The latest pose of this contact.
  Pose pose_;

  // Empty without the load profile.
  std::vector<double> row_loads_;
  std::vector<double> column_loads_;
  // Room for all taxels, or none if they are not copied.
  std::vector<TaxelLoad> loads_;
};

}  // namespace tactus
