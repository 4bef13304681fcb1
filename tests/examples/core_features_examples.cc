// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/contact_time.h"
#include "core/features/contact_track.h"
#include "core/features/contact_tracker.h"
#include "core/features/feature.h"
#include "core/features/load_profile.h"
#include "core/features/recent_poses.h"
#include "core/features/region_owners.h"
#include "core/features/segmenter.h"
#include "core/features/skin_tracker.h"
#include "core/features/taxel_rows.h"
#include "core/features/touch_finder.h"
#include "core/features/touched.h"
#include "core/light_touch/light_touch.h"
#include "core/light_touch/light_touch_kernels.h"
#include "core/light_touch/region_kernels.h"
#include "core/light_touch/region_sum.h"
#include "core/light_touch/row_marks.h"
#include "core/skin/normal_loads.h"
#include "core/skin/pose_spacing.h"
#include "core/skin/taxel_values.h"
#include "core/taxels/components.h"
#include "core/taxels/skin_range.h"
#include "core/taxels/taxel_embedding.h"
#include "core/taxels/whole_skin.h"

namespace tactus::internal::examples {

void Use(float load);
void Use(float force, int taxels, double row);
void Use(const Region& region);
void Use(const FrameFeatures& features);
void Use(uint64_t id, TouchPhase phase, const FrameFeatures& features);
void JoinThem();

struct SomeModel {
  void Reset();
  void Step(const ContactSample& sample);
};

static void ContactTrackerExample(const SkinLayout& layout,
                                  std::span<const FrameView> frames,
                                  SomeModel& model) {
#include "core/features/contact_tracker.h.inc"
}

static void ComponentsExample(const SkinLayout& layout, const FrameView& frame,
                              std::span<const uint64_t> touched_rows,
                              std::vector<TaxelLoad>& loads) {
#include "core/taxels/components.h.inc"
}

static void SkinTrackerExample(const SkinLayout& layout,
                               std::span<const FrameView> frames) {
#include "core/features/skin_tracker.h.inc"
}

static void ContactTrackExample(const SkinLayout& layout,
                                const ContactTrack::Options& options,
                                uint64_t id, const FrameView& frame,
                                const ContactTouch& touch, bool touched,
                                const RecentPoses& poses) {
#include "core/features/contact_track.h.inc"
}

static void TouchFinderExample(const SkinLayout& layout,
                               const FrameView& frame) {
#include "core/features/touch_finder.h.inc"
}

static void RegionOwnersExample(const SkinLayout& layout,
                                std::span<const RegionPlace> regions,
                                std::span<KnownContact> contacts) {
#include "core/features/region_owners.h.inc"
}

static void ContactTimeExample() {
#include "core/features/contact_time.h.inc"
}

static void TaxelRowsExample(const SkinLayout& layout,
                             const RegionPlace& region,
                             const RegionPlace& other) {
#include "core/features/taxel_rows.h.inc"
}

static void TaxelLoadExample() {
#include "core/taxels/taxel_load.h.inc"
}

static void TaxelEmbeddingExample(const TaxelEmbedding& embedding,
                                  const ContactSample& sample) {
#include "core/taxels/taxel_embedding.h.inc"
}

void Tell(std::span<const SkinRangeWatch::Reading> differing);

static void SkinRangeExample(
    const SkinRange& range,
    const std::vector<std::span<const TaxelLoad>>& frames) {
#include "core/taxels/skin_range.h.inc"
}

static void WholeSkinExample(const ContactSample& sample) {
#include "core/taxels/whole_skin.h.inc"
}

static void LightTouchExample(const SkinLayout& layout, const FrameView& frame,
                              float threshold, Segmenter& segmenter) {
#include "core/light_touch/light_touch.h.inc"
}

static void LightTouchKernelsExample(std::span<const float> taxels,
                                     const light_touch::Means& means) {
#include "core/light_touch/light_touch_kernels.h.inc"
}

static void RegionKernelsExample(const float* taxels, float* means) {
#include "core/light_touch/region_kernels.h.inc"
}

static void RowMarksExample(int column) {
#include "core/light_touch/row_marks.h.inc"
}

static void RegionSumExample(const SkinLayout& layout,
                             const SummedTaxels& taxels,
                             std::span<float> means) {
#include "core/light_touch/region_sum.h.inc"
}

static void LoadProfileExample(Segmenter& segmenter, const FrameView& frame,
                               std::span<double> row_loads,
                               std::span<double> column_loads) {
#include "core/features/load_profile.h.inc"
}

static void PoseSpacingExample() {
#include "core/skin/pose_spacing.h.inc"
}

static void RecentPosesExample(const Pose& pose, const Eigen::Vector3d& place,
                               const Eigen::Vector3d& direction) {
#include "core/features/recent_poses.h.inc"
}

static void SegmenterExample(const SkinLayout& layout, const FrameView& frame) {
#include "core/features/segmenter.h.inc"
}

static void TouchedExample(std::span<const float> taxels, float threshold) {
#include "core/features/touched.h.inc"
}

static void NormalLoadsExample(const SkinLayout& layout,
                               const FrameView& frame) {
#include "core/skin/normal_loads.h.inc"
}

static void TaxelValuesExample(v1::TaxelType type, const char* wire,
                               double scale, float limit,
                               std::span<float> taxels) {
#include "core/skin/taxel_values.h.inc"
}

static absl::Status FeatureExample(const ContactSample& sample) {
#include "core/features/feature.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
