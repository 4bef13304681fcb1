#include "core/cues/cue_tracker.h"

#include <algorithm>
#include <utility>

#include "core/cues/cue_math.h"

namespace tactus::internal {

CueTracker::CueTracker(double sample_rate_hz, CueGroups groups,
                       const TaxelEmbedding* embedding)
    : part_of_(CueCount(), -1), values_(CueCount()) {
  const CueContext context = {sample_rate_hz, embedding};
  smooth_window_ = context.Window(kSmoothS);
  groups |= GroupOf(Cue::kForce);
  size_t cue = 0;
  CueGroups bit = 1;
  for (const CueGroup& group : AllCueGroups()) {
    const size_t first = cue;
    for (const CueRow& row : group.rows) cue += row.count;
    const bool wanted = (groups & bit) != 0;
    bit <<= 1;
    auto computation = wanted ? group.make(context) : nullptr;
    if (computation == nullptr) continue;
    for (size_t i = first; i < cue; ++i) {
      part_of_[i] = static_cast<int>(parts_.size());
    }
    parts_.push_back({std::move(computation), first, cue - first});
  }
}

void CueTracker::Reset() {
  frames_ = 0;
  smooth_ = {};
  std::ranges::fill(values_, 0.0);
  for (Part& part : parts_) {
    part.computation->Reset();
    part.derived = true;
  }
}

void CueTracker::Step(const ContactSample& sample,
                      uint64_t frames_since_onset) {
  ++frames_;
  CueStep step = {.sample = sample,
                  .x = {ClampSample(sample.net_force),
                        ClampSample(sample.features[kContactArea]),
                        ClampSample(sample.features[kContactMotion])},
                  .smooth = {},
                  .frames = frames_,
                  .frames_since_onset = frames_since_onset};
  const double weight = step.Weight(smooth_window_);
  for (int i = 0; i < kFeatureCount; ++i) {
    smooth_[i] += weight * (step.x[i] - smooth_[i]);
  }
  step.smooth = smooth_;
  for (Part& part : parts_) {
    part.computation->Step(step);
    part.derived = false;
  }
}

void CueTracker::Derive(Part& part) {
  part.derived = true;
  part.computation->Derive(std::span(values_).subspan(part.first, part.count));
}

}  // namespace tactus::internal
