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

namespace tactus::internal {

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
  // Shear on the largest region; zero if untouched, on a skin of one axis, or
  // if it is not measured.
  Shear shear = {};
  // Number of regions on the whole skin.
  int region_count = 0;
  // Centroid of the largest region; while touch is lost, the last one.
  SkinPoint centroid = {};

  ContactSample sample() const {
    return {{max_force, area_m2, motion_m},
            net_force,
            profile,
            loads,
            spread,
            shear};
  }
};

// What a frame shows of one contact. All refer to the caller's memory.
struct ContactTouch {
  // The contact's largest region, and its taxels.
  const Region* region = nullptr;
  std::span<const uint64_t> rows;
  // All taxels that count as the contact's; only for the load profile and the
  // taxels' loads.
  std::span<const uint64_t> all_rows = {};
  // The loads of the skin's taxels.
  std::span<const float> values;
  // The frame's values of all axes.
  std::span<const float> axis_values;
  // It sums over rows.
  const Segmenter* segmenter = nullptr;
  // The largest reading in any region of the contact; if it is below
  // contact_threshold, also the largest TouchFinder::LightPeak, else 0.
  float max_value = 0;
  double light_peak = 0;
};

class ContactTrack {
 public:
  // A mean of light touch that is above this times what is left of an earlier
  // load, and Options::least_light, is that of a load that is there.
  static constexpr double kAboveFading = 1.2;

  struct Options {
    double sample_rate_hz = 100;
    // Seconds; below 0 a contact is never released.
    double release_after_s = 0.5;
    bool load_profile = true;
    bool taxel_loads = false;
    // With taxel_loads.
    bool taxel_components = false;
    bool load_spread = false;
    bool shear = false;
    // A contact also ends before release_after_s when it is clearly over, and
    // frames in which it is not felt count as a loss of touch. It is felt while
    // a taxel reads contact_threshold. On a skin with light touch it is also
    // felt while the largest mean of its region is above what is left of an
    // earlier load (kAboveFading): once a load is gone, means fall by `fading`
    // in each frame. It is over
    //   - when it was firm and is not felt for longer than a bounce takes,
    //     0.25 s. It was firm if, within the second before it was felt last,
    //     some taxel read contact_threshold in each frame of 0.1 s, or one read
    //     20 times as much;
    //   - when it was not felt for 0.25 s and then some taxel reads 4 times
    //     contact_threshold: that is the load of another contact;
    //   - when the skin has drawn back by 5 mm from where it was felt last.
    bool release_by_evidence = false;
    // Those of TouchFinder.
    double fading = 0;
    double least_light = 0;
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
  // With release_by_evidence: it does not touch, or all that is felt is what is
  // left of an earlier load; and the largest mean that is left of it.
  bool unfelt() const { return unfelt_frames_ > 0; }
  // It was not felt for longer than 0.1 s.
  bool is_lost() const { return unfelt_frames_ > steady_frames_; }
  double light_left() const { return light_left_; }

 private:
  // Counts a loss of touch; true once it is too long.
  bool Lost(const FrameView& frame, bool touched);
  // Counts frames in which it is not felt; true if it is clearly over.
  bool IsClearlyOver(const FrameView& frame, const ContactTouch* touch,
                     const RecentPoses& poses);
  // Takes a frame in which it is felt, by its largest reading and light_peak.
  void KeepFelt(float largest, double light_peak);
  // True if the skin has drawn back since the contact was felt last.
  bool HasDrawnBack(const RecentPoses& poses);
  // Measures all features but the motion.
  void Measure(const ContactTouch& touch);
  void MeasureNothing();
  double Motion(const Pose* pose);

  SkinLayout layout_;
  // Frames of lost touch that release a contact, the largest value means never;
  // those after which a firm contact is over; those of a steady load that make
  // a contact firm, and those after which it is firm no more.
  uint64_t release_frames_;
  uint64_t firm_release_frames_;
  uint64_t steady_frames_;
  uint64_t recent_frames_;
  const Options options_;
  float contact_threshold_;

  uint64_t id_ = 0;
  FrameFeatures features_;
  uint64_t lost_frames_ = 0;
  // Frames since it was felt last.
  uint64_t unfelt_frames_ = 0;
  // Frames with a taxel at contact_threshold in a row; and, when it was felt
  // last, frames since it was firm.
  uint64_t loaded_frames_ = 0;
  uint64_t since_firm_ = 0;
  // Its largest reading when it was felt last, and what is left of the largest
  // mean since then.
  float load_ = 0;
  double light_left_ = 0;
  // How far out the skin was, at the most, since it was felt last.
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

}  // namespace tactus::internal
