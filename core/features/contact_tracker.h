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
#include <optional>
#include <span>
#include <vector>

#include "Eigen/Core"
#include "core/features/feature.h"
#include "core/features/recent_poses.h"
#include "core/features/segmenter.h"
#include "core/light_touch/light_touch.h"
#include "core/skin/frame.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

// The features of one frame. Outside of a contact all are zero except `touched`
// and `region_count`.
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
  // How far the contact has moved since its onset, in metres. If frames come
  // with poses: along the outward normal that the skin had at onset, in the
  // world; above 0 outwards, i.e. into the object. Else the distance of the
  // centroid from its place at onset, along the skin; never below 0.
  double motion_m = 0;
  // Load profile of the whole skin; zero if untouched, or if the tracker does
  // not compute it.
  LoadProfile profile = {};
  // The touched taxels of the whole skin; empty if untouched, or if the tracker
  // does not copy them. Valid until the next Step().
  std::span<const TaxelLoad> loads = {};
  // Spread of the largest region; zero if untouched, or if the tracker does not
  // measure it.
  LoadSpread spread = {};
  // Number of regions on the skin.
  int region_count = 0;
  // Centroid of the largest region; while touch is lost, the last one.
  SkinPoint centroid = {};

  ContactSample sample() const {
    return {{max_force, area_m2, motion_m}, net_force, profile, loads, spread};
  }
};

enum class ContactState { kNoContact, kInContact, kReleased };

// Follows one contact after another on one skin.
//
// A contact begins (onset) when a taxel reaches onset_threshold. It continues
// while any taxel is at or above contact_threshold, and through losses of touch
// shorter than release_after_s. Then it is released. The next onset begins a
// new contact, on a later frame.
//
// On a skin with light touch (light_touch.h) both thresholds apply to what a
// taxel reads above its background, and a contact also begins when a region's
// mean reaches light_touch.onset_threshold. The region of a contact are the
// taxels that feel something over the window, the level for a single taxel
// being light_touch.contact_threshold times the square root of the taxels in a
// region, as the noise; if there are none, those at contact_threshold at once.
// Its force is what they read above their background at once, so it does not
// lag behind the motion. No contact begins in the first 0.3 s.
//
// The length of a loss counts its untouched frames and the frames that went
// missing in it. Frames that go missing between two touched frames do not end a
// contact.
//
// With poses the motion has a sign, so that the errors of the poses have a mean
// of 0. It is measured from where the poses of the last 0.2 s put the contact
// at onset (RecentPoses), because an error of one pose at onset would stay in
// the whole contact. As long as the region still covers the place where the
// contact began, the motion is the motion of that place. A growing region moves
// its centroid by whole taxels, and poses are a hundred times finer. After the
// region has left the place, the motion is that of its centroid. So a contact
// that travels over the skin while the link rests moves on a cylinder by how
// much lower the new place lies along the normal, and on a flat skin not at
// all; a link that rolls over an object at rest does not move.
//
// While touch is lost, force and area are 0. The last touched point stays fixed
// to the skin: it moves with the pose, and does not move without poses.
class ContactTracker {
 public:
  struct Options {
    // Above 0.
    double sample_rate_hz = 100;
    // Seconds; below 0 a contact is never released.
    double release_after_s = 0.5;
    // If false, the load profile stays 0. For models that do not use it.
    bool load_profile = true;
    // If true, `loads` has the touched taxels.
    bool taxel_loads = false;
    // If true, `spread` is measured.
    bool load_spread = false;
    // Skips that change no bit. skip_untouched: frames without a touched taxel
    // are not segmented. reuse_unchanged: a frame whose taxels equal those of
    // the touched frame before it keeps the features, except for the motion.
    // skip_quiet_rows: of a skin with light touch, only regions near taxels
    // that feel something are summed.
    bool skip_untouched = true;
    bool reuse_unchanged = true;
    bool skip_quiet_rows = true;
  };

  // `layout` must be valid.
  ContactTracker(const SkinLayout& layout, const Options& options);

  // Forgets everything, as if new.
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
  // True if the last frame's taxels equalled those of the frame before.
  bool reused() const { return reused_; }
  // Rows of the last frame whose regions were not summed.
  int quiet_rows() const { return quiet_rows_; }

  // The segmentation of the last frame.
  const Segmenter& segmenter() const { return segmenter_; }

 private:
  // Finds the regions of a frame and returns how many there are; *begins is
  // true if they reach an onset threshold.
  int Segment(std::span<const float> taxels, bool* begins);
  int SegmentLight(std::span<const float> taxels, bool* begins);
  void Begin(const FrameView& frame);
  // True if features_ were measured from equal taxels.
  bool Unchanged(std::span<const float> taxels) const;
  // Counts a loss of touch; true once it is too long.
  bool Lost(const FrameView& frame);
  // Measures all features of the segmented frame but the motion.
  void Measure(const FrameView& frame);
  double Motion(const Pose* pose);

  SkinLayout layout_;
  Segmenter segmenter_;
  float contact_threshold_;
  float onset_threshold_;
  std::optional<LightTouchFilter> light_;
  // Level of a single taxel over the window.
  float light_taxel_ = 0;
  // Frames of lost touch that release a contact; the largest value means never.
  uint64_t release_frames_;

  const bool measure_spread_;

  ContactState state_ = ContactState::kNoContact;
  bool onset_ = false;
  bool released_ = false;
  bool reused_ = false;
  int quiet_rows_ = 0;
  FrameFeatures features_;
  // The taxels of the last frame, if it was touched and part of a contact.
  // Empty if frames are never compared, as on a skin with light touch, whose
  // means change with every frame.
  std::vector<float> measured_taxels_;
  bool measured_ = false;
  // Frames since the last touched one, up to release_frames_.
  uint64_t lost_frames_ = 0;
  // The place where the current contact began: on the skin, in the link's frame
  // and in the world.
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
  RecentPoses recent_poses_;

  // Empty without the load profile.
  std::vector<double> row_loads_;
  std::vector<double> column_loads_;
  // Room for all taxels, or none if they are not copied.
  std::vector<TaxelLoad> loads_;
};

}  // namespace tactus
