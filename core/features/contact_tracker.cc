#include "core/features/contact_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/features/load_profile.h"

namespace tactus {
namespace {

constexpr uint64_t kNever = std::numeric_limits<uint64_t>::max();
// Longer than any stream, and exact in a double.
constexpr double kMaxReleaseFrames = 0x1p53;

uint64_t ReleaseFrames(const ContactTracker::Options& options) {
  if (options.release_after_s < 0) return kNever;
  const double frames = options.release_after_s * options.sample_rate_hz;
  // 0.07 s at 100 Hz is 7 frames, though the product is 7.000000000000001.
  const double whole = std::ceil(frames * (1 - 1e-12));
  return static_cast<uint64_t>(std::clamp(whole, 1.0, kMaxReleaseFrames));
}

Eigen::Vector3d WorldPosition(const Eigen::Vector3d& link_position,
                              const Pose& pose) {
  return pose.position + pose.orientation * link_position;
}

// The taxel nearest to a centroid.
int NearestTaxel(const SkinLayout& layout, const SkinPoint& point) {
  const auto row = static_cast<int>(std::lround(point.row));
  const auto column = static_cast<int>(std::lround(point.column));
  return row * layout.columns + column % layout.columns;
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

ContactTracker::ContactTracker(const SkinLayout& layout, const Options& options)
    : layout_(layout),
      segmenter_(layout, options.skip_untouched),
      contact_threshold_(TaxelThreshold(layout.contact_threshold)),
      onset_threshold_(TaxelThreshold(layout.onset_threshold)),
      release_frames_(ReleaseFrames(options)),
      measure_spread_(options.load_spread),
      measured_taxels_(
          options.reuse_unchanged && !layout.light_touch ? layout.taxels() : 0),
      recent_poses_(options.sample_rate_hz),
      row_loads_(options.load_profile ? layout.rows : 0),
      column_loads_(options.load_profile ? layout.columns : 0) {
  if (options.taxel_loads) loads_.reserve(layout.taxels());
  if (!layout.light_touch) return;
  const LightTouch& light = *layout.light_touch;
  light_.emplace(layout, options.sample_rate_hz, options.skip_quiet_rows);
  light_taxel_ = static_cast<float>(light.contact_threshold *
                                    std::sqrt(light.rows * light.columns));
}

void ContactTracker::Reset() {
  state_ = ContactState::kNoContact;
  onset_ = false;
  released_ = false;
  reused_ = false;
  quiet_rows_ = 0;
  measured_ = false;
  recent_poses_.Reset();
  if (light_) light_->Reset();
  features_ = FrameFeatures();
}

bool ContactTracker::Unchanged(std::span<const float> taxels) const {
  return measured_ && std::memcmp(taxels.data(), measured_taxels_.data(),
                                  taxels.size_bytes()) == 0;
}

const FrameFeatures& ContactTracker::Step(const FrameView& frame) {
  onset_ = false;
  released_ = false;
  recent_poses_.Add(frame.pose, frame.missing_before);
  reused_ = Unchanged(frame.taxels);
  bool begins = false;
  if (!reused_) {
    features_.region_count = Segment(frame.taxels, &begins);
    features_.touched = features_.region_count > 0;
  }
  if (state_ == ContactState::kInContact) {
    if (Lost(frame)) {
      state_ = ContactState::kReleased;
      released_ = true;
    }
  } else if (features_.touched && begins) {
    Begin(frame);
  }
  measured_ = false;
  if (state_ != ContactState::kInContact) {
    features_ = {.touched = features_.touched,
                 .region_count = features_.region_count};
    return features_;
  }
  if (!reused_) Measure(frame);
  features_.motion_m = Motion(frame.pose);
  measured_ = features_.touched && !measured_taxels_.empty();
  if (measured_ && !reused_) {
    std::ranges::copy(frame.taxels, measured_taxels_.begin());
  }
  return features_;
}

int ContactTracker::Segment(std::span<const float> taxels, bool* begins) {
  if (light_) return SegmentLight(taxels, begins);
  const int regions = segmenter_.Segment(taxels);
  *begins = segmenter_.peak() >= onset_threshold_;
  return regions;
}

int ContactTracker::SegmentLight(std::span<const float> taxels, bool* begins) {
  light_->Step(taxels);
  const LightTouch& light = *layout_.light_touch;
  const auto contact = static_cast<float>(light.contact_threshold);
  const auto segment = [&](std::span<const float> shape, float threshold) {
    return segmenter_.Segment(shape, threshold, light_->values());
  };
  *begins = light_->peak() >= onset_threshold_ ||
            light_->region_peak() >= static_cast<float>(light.onset_threshold);
  quiet_rows_ = light_->quiet_rows();
  int regions = 0;
  if (light_->has_shape()) {
    regions = segment(light_->shape(), light_taxel_);
  } else {
    segmenter_.Clear();
  }
  if (regions == 0 && light_->peak() >= contact_threshold_) {
    regions = segment(light_->values(), contact_threshold_);
  }
  if (regions == 0 && light_->region_peak() >= contact) {
    regions = segment(light_->shape(), contact);
  }
  return regions;
}

void ContactTracker::Begin(const FrameView& frame) {
  state_ = ContactState::kInContact;
  onset_ = true;
  lost_frames_ = 0;
  const Region& region = segmenter_.largest();
  onset_point_ = {region.centroid_row, region.centroid_column};
  travelled_ = false;
  has_pose_ = frame.pose != nullptr;
  if (has_pose_) {
    pose_ = *frame.pose;
    onset_link_position_ = LinkPosition(layout_, onset_point_);
    onset_position_ = WorldPosition(onset_link_position_, pose_);
    onset_normal_ = pose_.orientation * LinkNormal(layout_, onset_point_);
    onset_error_ =
        recent_poses_.NewestError(onset_link_position_, onset_normal_);
  }
}

bool ContactTracker::Lost(const FrameView& frame) {
  // Missing frames belong to the loss if it began before them.
  const bool going_on = lost_frames_ > 0;
  if (going_on || !features_.touched) {
    const uint64_t room = release_frames_ - lost_frames_;
    lost_frames_ += std::min(frame.missing_before, room);
    if (lost_frames_ < release_frames_ && !features_.touched) ++lost_frames_;
    if (lost_frames_ == release_frames_ && release_frames_ != kNever) {
      return true;
    }
  }
  if (features_.touched) lost_frames_ = 0;
  return false;
}

void ContactTracker::Measure(const FrameView& frame) {
  if (features_.touched) {
    const Region& region = segmenter_.largest();
    features_.max_force = region.max_value;
    features_.net_force = region.total;
    features_.area_taxels = region.taxels;
    features_.area_m2 = region.taxels * layout_.taxel_area_m2;
    if (!row_loads_.empty()) {
      segmenter_.SumLoads(light_ ? light_->values() : frame.taxels, row_loads_,
                          column_loads_);
      features_.profile = MakeLoadProfile(row_loads_, column_loads_);
    }
    if (loads_.capacity() > 0) {
      segmenter_.CopyLoads(light_ ? light_->values() : frame.taxels, loads_);
      features_.loads = loads_;
    }
    if (measure_spread_) {
      features_.spread =
          segmenter_.LargestSpread(light_ ? light_->values() : frame.taxels);
      features_.spread.rows *=
          static_cast<float>(layout_.row_pitch_m * layout_.row_pitch_m);
      features_.spread.columns *=
          static_cast<float>(layout_.column_pitch_m * layout_.column_pitch_m);
    }
    features_.centroid = {region.centroid_row, region.centroid_column};
    // A region with a hole, or in the shape of an L, may not hold the place of
    // its own centroid; a long one may not reach one that it holds.
    travelled_ =
        !segmenter_.LargestHolds(NearestTaxel(layout_, onset_point_)) &&
        !Reaches(layout_, region, onset_point_);
  } else {
    features_.max_force = 0;
    features_.net_force = 0;
    features_.area_taxels = 0;
    features_.area_m2 = 0;
    features_.profile = {};
    features_.loads = {};
    features_.spread = {};
  }
}

double ContactTracker::Motion(const Pose* pose) {
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

}  // namespace tactus
