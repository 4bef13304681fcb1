// The paper's features themselves; force is that of the largest taxel.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class RawFeatureValues final : public CueComputation {
 public:
  explicit RawFeatureValues(const CueContext&) {}
  void Reset() override { values_ = {}; }
  void Step(const CueStep& step) override {
    for (int i = 0; i < kFeatureCount; ++i) {
      values_[i] = ClampSample(step.sample.features[i]);
    }
  }
  void Derive(std::span<double> cues) const override {
    std::ranges::copy(values_, cues.begin());
  }

 private:
  FeatureVector values_ = {};
};

}  // namespace

CueGroup RawFeatures() {
  return {.name = "features",
          .rows = {{"force", kNeedsForce, kPace, "largest taxel's force, N"},
                   {"area", kNeedsArea, kLoad | kStiffness | kPace,
                    "contact area, m^2"},
                   {"motion", kNeedsMotion, kStiffness | kPace,
                    "contact motion, m"}},
          .make = MakeCues<RawFeatureValues>};
}

}  // namespace tactus::internal
