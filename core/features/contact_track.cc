#include "core/features/contact_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/features/load_profile.h"
#include "core/taxels/components.h"

namespace tactus::internal {
namespace {

constexpr uint64_t kNever = std::numeric_limits<uint64_t>::max();
// Longer than any stream, and exact in a double.
constexpr double kMaxReleaseFrames = 0x1p53;

// Longer than all but one in 500 bounces of a strong contact of the random
// world, and shorter than people take to touch again.
constexpr double kGoneS = 0.25;
// A load of this time is no bounce.
constexpr double kSteadyS = 0.1;
// A strong contact's largest taxel, and one that is too much for what comes
// back after kGoneS, in contact_thresholds.
constexpr double kStrong = 20;
constexpr double kNewLoad = 4;
// A contact stays firm for this time.
constexpr double kRecentS = 1;
// A skin that has drawn back this far has let go. Above the noise of poses.
constexpr double kDrawnBackM = 0.005;
// Noise alone is seldom above this share of the least mean that is felt.
constexpr double kHalf = 0.5;
// A shorter loss says nothing.
constexpr uint64_t kLeastLoss = 3;

// 0.07 s at 100 Hz is 7 frames, though the product is 7.000000000000001.
uint64_t WholeFrames(double seconds, double rate) {
  const double whole = std::ceil(seconds * rate * (1 - 1e-12));
  return static_cast<uint64_t>(std::clamp(whole, 1.0, kMaxReleaseFrames));
}

uint64_t ReleaseFrames(const ContactTrack::Options& options) {
  if (options.release_after_s < 0) return kNever;
  return WholeFrames(options.release_after_s, options.sample_rate_hz);
}

Eigen::Vector3d WorldPosition(const Eigen::Vector3d& link_position,
                              const Pose& pose) {
  return pose.position + pose.orientation * link_position;
}

// True if `rows` have the taxel nearest to a centroid.
bool Holds(const SkinLayout& layout, std::span<const uint64_t> rows,
           const SkinPoint& point) {
  const auto row = static_cast<size_t>(std::lround(point.row));
  const auto column = static_cast<int>(std::lround(point.column));
  return (rows[row] >> (column % layout.columns) & 1) != 0;
}

// True if a region as large and round as `region` around its centroid holds
// `point`.
bool Reaches(const SkinLayout& layout, const Region& region,
             const SkinPoint& point) {
  const double area =
      region.taxels * layout.row_pitch_m * layout.column_pitch_m;
  const double radius = std::sqrt(area / std::numbers::pi);
  return SkinDistance(layout, {region.centroid_row, region.centroid_column},
                      point) <= radius;
}

}  // namespace

ContactTrack::ContactTrack(const SkinLayout& layout, const Options& options)
    : layout_(layout),
      release_frames_(ReleaseFrames(options)),
      firm_release_frames_(WholeFrames(kGoneS, options.sample_rate_hz)),
      steady_frames_(WholeFrames(kSteadyS, options.sample_rate_hz)),
      recent_frames_(WholeFrames(kRecentS, options.sample_rate_hz)),
      options_(options),
      contact_threshold_(TaxelThreshold(layout.contact_threshold)),
      row_loads_(options.load_profile ? layout.rows : 0),
      column_loads_(options.load_profile ? layout.columns : 0) {
  if (options.taxel_loads) loads_.reserve(ShapeOf(layout).total());
}

void ContactTrack::Begin(uint64_t id, const FrameView& frame,
                         const ContactTouch& touch, const RecentPoses& poses) {
  id_ = id;
  features_ = {};
  lost_frames_ = 0;
  unfelt_frames_ = 0;
  loaded_frames_ = 0;
  since_firm_ = recent_frames_;
  onset_point_ = {touch.region->centroid_row, touch.region->centroid_column};
  travelled_ = false;
  has_pose_ = frame.pose != nullptr;
  if (has_pose_) {
    pose_ = *frame.pose;
    onset_link_position_ = LinkPosition(layout_, onset_point_);
    onset_position_ = WorldPosition(onset_link_position_, pose_);
    onset_normal_ = pose_.orientation * LinkNormal(layout_, onset_point_);
    onset_error_ = poses.NewestError(onset_link_position_, onset_normal_);
  }
  KeepFelt(touch.max_value, touch.light_peak);
  Measure(touch);
  features_.motion_m = Motion(frame.pose);
}

bool ContactTrack::Step(const FrameView& frame, const ContactTouch* touch,
                        const RecentPoses& poses) {
  if (Lost(frame, touch != nullptr)) return false;
  if (frame.pose != nullptr) pose_ = *frame.pose;
  if (options_.release_by_evidence && IsClearlyOver(frame, touch, poses)) {
    return false;
  }
  if (touch != nullptr) {
    Measure(*touch);
  } else {
    MeasureNothing();
  }
  features_.motion_m = Motion(frame.pose);
  return true;
}

void ContactTrack::Pause(const FrameView& frame) {
  MeasureNothing();
  features_.motion_m = Motion(frame.pose);
}

void ContactTrack::StepUnchanged(const FrameView& frame) {
  // There is no light touch where frames are compared.
  KeepFelt(load_, /*light_peak=*/0);
  features_.motion_m = Motion(frame.pose);
}

bool ContactTrack::Lost(const FrameView& frame, bool touched) {
  // Missing frames belong to the loss if it began before them.
  const bool going_on = lost_frames_ > 0;
  if (going_on || !touched) {
    const uint64_t room = release_frames_ - lost_frames_;
    lost_frames_ += std::min(frame.missing_before, room);
    if (lost_frames_ < release_frames_ && !touched) ++lost_frames_;
    if (lost_frames_ == release_frames_ && release_frames_ != kNever) {
      return true;
    }
  }
  if (touched) lost_frames_ = 0;
  return false;
}

bool ContactTrack::IsClearlyOver(const FrameView& frame,
                                 const ContactTouch* touch,
                                 const RecentPoses& poses) {
  const bool is_loaded =
      touch != nullptr && touch->max_value >= contact_threshold_;
  const double light_peak = touch == nullptr ? 0 : touch->light_peak;
  const double above_left = light_peak - kAboveFading * light_left_;
  const bool is_felt =
      is_loaded || (loaded_frames_ == 0 && above_left > options_.least_light);
  if (is_felt && unfelt_frames_ == 0) {
    KeepFelt(touch->max_value, light_peak);
    return false;
  }
  if (unfelt_frames_ == 0) {
    farthest_m_ = -std::numeric_limits<double>::max();
  } else {
    unfelt_frames_ += frame.missing_before;
  }
  const bool drawn_back = HasDrawnBack(poses);
  const bool was_firm = since_firm_ < recent_frames_;
  const bool is_new_load =
      is_loaded && touch->max_value >= kNewLoad * contact_threshold_;
  // A light touch may be there that is about to show.
  const bool may_be_felt =
      !is_loaded && above_left > kHalf * options_.least_light;
  const uint64_t gone = unfelt_frames_ + !is_felt;
  const bool is_over =
      gone >= release_frames_ ||
      (!may_be_felt &&
       (((was_firm || is_new_load) && gone >= firm_release_frames_) ||
        (drawn_back && gone >= kLeastLoss)));
  if (!is_felt) {
    unfelt_frames_ = gone;
    // As much of a load is left as there is.
    light_left_ =
        loaded_frames_ > 0 ? light_peak : light_left_ * options_.fading;
    loaded_frames_ = 0;
  } else if (!is_over) {
    KeepFelt(touch->max_value, light_peak);
  }
  return is_over;
}

void ContactTrack::KeepFelt(float largest, double light_peak) {
  load_ = largest;
  light_left_ = light_peak;
  loaded_frames_ = largest >= contact_threshold_ ? loaded_frames_ + 1 : 0;
  const bool is_firm = loaded_frames_ >= steady_frames_ ||
                       largest >= kStrong * contact_threshold_;
  since_firm_ =
      is_firm ? 0 : std::min(since_firm_ + unfelt_frames_ + 1, recent_frames_);
  unfelt_frames_ = 0;
}

bool ContactTrack::HasDrawnBack(const RecentPoses& poses) {
  if (!has_pose_) return false;
  const double out_m =
      onset_normal_.dot(WorldPosition(onset_link_position_, pose_) -
                        onset_position_) -
      poses.NewestError(onset_link_position_, onset_normal_);
  farthest_m_ = std::max(farthest_m_, out_m);
  return farthest_m_ - out_m >= kDrawnBackM;
}

void ContactTrack::MeasureNothing() {
  const SkinPoint centroid = features_.centroid;
  features_ = {};
  features_.centroid = centroid;
}

void ContactTrack::Measure(const ContactTouch& touch) {
  const Region& region = *touch.region;
  features_.touched = true;
  features_.max_force = region.max_value;
  features_.net_force = region.total;
  features_.area_taxels = region.taxels;
  features_.area_m2 = region.taxels * layout_.taxel_area_m2;
  if (!row_loads_.empty()) {
    touch.segmenter->SumLoads(touch.values, touch.all_rows, row_loads_,
                              column_loads_);
    features_.profile = MakeLoadProfile(row_loads_, column_loads_);
  }
  if (loads_.capacity() > 0) {
    touch.segmenter->CopyLoads(touch.values, touch.all_rows, loads_);
    if (options_.taxel_components) {
      AddComponents(layout_, touch.axis_values, touch.all_rows, loads_);
    }
    features_.loads = loads_;
  }
  if (options_.load_spread) {
    features_.spread =
        touch.segmenter->Spread(touch.values, touch.rows, region);
    features_.spread.rows *=
        static_cast<float>(layout_.row_pitch_m * layout_.row_pitch_m);
    features_.spread.columns *=
        static_cast<float>(layout_.column_pitch_m * layout_.column_pitch_m);
  }
  if (options_.shear) {
    features_.shear = SumShear(layout_, touch.axis_values, touch.rows);
  }
  features_.region_count = touch.segmenter->regions();
  features_.centroid = {region.centroid_row, region.centroid_column};
  // A region with a hole, or in the shape of an L, may not hold the place of
  // its own centroid; a long one may not reach one that it holds.
  travelled_ = !Holds(layout_, touch.rows, onset_point_) &&
               !Reaches(layout_, region, onset_point_);
}

double ContactTrack::Motion(const Pose* pose) {
  if (!has_pose_) {
    return SkinDistance(layout_, features_.centroid, onset_point_);
  }
  if (pose != nullptr) pose_ = *pose;
  const Eigen::Vector3d position =
      WorldPosition(travelled_ ? LinkPosition(layout_, features_.centroid)
                               : onset_link_position_,
                    pose_);
  return onset_normal_.dot(position - onset_position_) + onset_error_;
}

}  // namespace tactus::internal
