// How much the features change from frame to frame, over the whole contact.
#include <array>

#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class Roughness final : public CueComputation {
 public:
  explicit Roughness(const CueContext&) {}
  void Reset() override { state_ = {}; }
  void Step(const CueStep& step) override {
    const double weight = 1 / step.frames;
    for (int i = 0; i < kFeatureCount; ++i) {
      const double change = step.frames == 1 ? 0 : step.x[i] - state_.last[i];
      state_.squares[i].Step(change * change, weight);
    }
    state_.last = step.x;
  }
  void Derive(std::span<double> cues) const override {
    constexpr double kFloor[] = {kForceFloor, kAreaFloor, kMotionFloor};
    for (int i = 0; i < kFeatureCount; ++i) {
      // Roughness is far smaller than the level.
      cues[i] = 0.5 * std::log(state_.squares[i].value +
                               kFloor[i] * kFloor[i] * kRippleFloor);
    }
  }

 private:
  struct State {
    FeatureVector last = {};
    // Mean squared changes.
    std::array<RunningMean, kFeatureCount> squares;
  };
  State state_;
};

}  // namespace

CueGroup RoughnessCues() {
  constexpr absl::string_view kMeaning =
      "log of the root mean square change from frame to frame";
  return {.name = "roughness",
          .rows = {{"force_roughness", kNeedsForce, 0, kMeaning},
                   {"area_roughness", kNeedsArea, kLoad | kStiffness, kMeaning},
                   {"motion_roughness", kNeedsMotion, kStiffness, kMeaning}},
          .standard = true,
          .make = MakeCues<Roughness>};
}

}  // namespace tactus::internal
