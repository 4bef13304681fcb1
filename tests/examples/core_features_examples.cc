// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/contact_tracker.h"
#include "core/features/cues.h"
#include "core/features/feature.h"
#include "core/features/load_profile.h"
#include "core/features/recent_poses.h"
#include "core/features/segmenter.h"
#include "core/features/touched.h"
#include "core/light_touch/light_touch.h"
#include "core/light_touch/light_touch_kernels.h"
#include "core/light_touch/region_sum.h"
#include "core/skin/pose_spacing.h"
#include "core/skin/taxel_values.h"
#include "core/taxels/taxel_embedding.h"
#include "core/taxels/whole_skin.h"

namespace tactus::examples {

void Use(float force, int taxels, double row);

struct SomeModel {
  void Reset();
  void Step(const ContactSample& sample);
};

void ContactTrackerExample(const SkinLayout& layout,
                           std::span<const FrameView> frames,
                           SomeModel& model) {
  ContactTracker tracker(layout, {.sample_rate_hz = 100});
  for (const FrameView& frame : frames) {
    const FrameFeatures& features = tracker.Step(frame);
    if (tracker.onset()) model.Reset();
    if (tracker.state() == ContactState::kInContact) {
      model.Step(features.sample());
    }
  }
}

void CuesExample(const ContactSample& sample) {
  CueTracker tracker(/*sample_rate_hz=*/100);
  tracker.Step(sample, /*frames_since_onset=*/1);
  double cue = tracker.value(Cue::kLogSpring);
}

void TaxelLoadExample() {
  std::vector<TaxelLoad> loads = {{.taxel = 17, .root = 0.5F}};
}

void TaxelEmbeddingExample(const TaxelEmbedding& embedding,
                           const ContactSample& sample) {
  EmbeddingTracker tracker(&embedding, /*sample_rate_hz=*/100);
  tracker.Step(sample.loads);
  const double first = tracker.values()[0];
}

void WholeSkinExample(const ContactSample& sample) {
  WholeSkinTracker tracker(/*taxels=*/384, /*sample_rate_hz=*/100);
  tracker.Step(sample.loads);
  const double root_force = tracker.numbers().root_force;
}

void LightTouchExample(const SkinLayout& layout, const FrameView& frame,
                       float threshold, Segmenter& segmenter) {
  LightTouchFilter filter(layout, /*sample_rate_hz=*/100);
  filter.Step(frame.taxels);
  if (filter.region_peak() >= layout.light_touch->onset_threshold) {
    segmenter.Segment(filter.shape(), threshold, filter.values());
  }
}

void LightTouchKernelsExample(std::span<const float> taxels,
                              const light_touch::Means& means) {
  const float peak =
      light_touch::StepMeans(taxels, 0.05F, 0.01F, 0.001F, means).value;
}

void RegionSumExample(const SkinLayout& layout, const SummedTaxels& taxels,
                      std::span<float> means) {
  RegionSum sum(layout, {.above = 1, .below = 1, .left = 1, .right = 1});
  const float largest =
      sum.Run(taxels, /*scale=*/1.0F / 9, {.begin = 0, .end = 16}, means);
}

void LoadProfileExample(Segmenter& segmenter, const FrameView& frame,
                        std::span<double> row_loads,
                        std::span<double> column_loads) {
  segmenter.Segment(frame.taxels);
  segmenter.SumLoads(frame.taxels, row_loads, column_loads);
  const LoadProfile profile = MakeLoadProfile(row_loads, column_loads);
}

void PoseSpacingExample() {
  PoseSpacing spacing(/*sample_rate_hz=*/100);
  spacing.Step(/*missing_before=*/0);
  const bool kept = spacing.Keep();
}

void RecentPosesExample(const Pose& pose, const Eigen::Vector3d& place,
                        const Eigen::Vector3d& direction) {
  RecentPoses poses(/*sample_rate_hz=*/100);
  poses.Add(&pose, /*missing_before=*/0);
  const double error_m = poses.NewestError(place, direction);
}

void SegmenterExample(const SkinLayout& layout, const FrameView& frame) {
  Segmenter segmenter(layout);
  if (segmenter.Segment(frame.taxels) > 0) {
    const Region& region = segmenter.largest();
    Use(region.max_value, region.taxels, region.centroid_row);
  }
}

void TouchedExample(std::span<const float> taxels, float threshold) {
  std::vector<uint64_t> bits(TouchedWords(taxels.size()));
  if (FindTouched(taxels, threshold, bits)) {
    const TouchedSum sum = SumTouched(taxels, bits);
  }
}

void FindTheBadOne();

void TaxelValuesExample(const char* wire, double scale, float limit,
                        std::span<float> taxels) {
  if (!ScaleTaxels<uint16_t>(wire, scale, limit, taxels)) FindTheBadOne();
}

absl::Status FeatureExample(const ContactSample& sample) {
  TACTUS_ASSIGN_OR_RETURN(auto features, ParseFeatures("f,m"));
  sample.features[static_cast<int>(Feature::kForce)];
  return absl::OkStatus();
}

}  // namespace tactus::examples
