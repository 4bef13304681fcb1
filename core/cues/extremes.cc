// The smallest area and the largest force so far, and how far the contact has
// come from them.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

// The anti-aliasing filter has settled after these seconds.
constexpr double kSettledS = 0.03;
// Below this fraction, the signed logarithm is nearly linear.
constexpr double kGrowthKnee = 1e-5;

class Extremes final : public CueComputation {
 public:
  explicit Extremes(const CueContext& context)
      : settled_frames_(kSettledS * context.sample_rate_hz) {}
  void Reset() override { state_ = {}; }
  void Step(const CueStep& step) override {
    State& s = state_;
    s.force = step.smooth[kNetForce];
    s.area = step.smooth[kContactArea];
    const bool settled = step.frames > settled_frames_;
    s.first_area = settled ? std::min(s.first_area, s.area) : s.area;
    s.largest_force = std::max(s.largest_force, s.force);
  }
  void Derive(std::span<double> cues) const override {
    const State& s = state_;
    const double log_force = LogAbove(s.force, kForceFloor);
    const double log_largest = LogAbove(s.largest_force, kForceFloor);
    cues[0] = LogAbove(s.first_area, kAreaFloor);
    cues[1] = SignedLog(
        Ratio(s.area - s.first_area, std::max(s.first_area, kAreaFloor)),
        kGrowthKnee);
    cues[2] = log_largest;
    cues[3] = log_force - log_largest;
    cues[4] = log_force - 1.5 * LogAbove(s.area, kAreaFloor);
  }

 private:
  struct State {
    double force = 0;
    double area = 0;
    double first_area = 0;
    double largest_force = 0;
  };
  double settled_frames_;
  State state_;
};

}  // namespace

CueGroup ExtremeCues() {
  return {.name = "extremes",
          .rows = {{"log_first_area", kNeedsArea, kPace | kLoad | kStiffness,
                    "log of the smallest smooth area after the filter has "
                    "settled (30 ms)"},
                   {"area_growth", kNeedsArea, kPace | kLoad | kStiffness,
                    "relative growth of the area since then, signed log"},
                   {"log_largest_force", kNeedsForce, kPace,
                    "log of the largest smooth force so far"},
                   {"force_drop", kNeedsForce, kPace | kLoad | kStiffness,
                    "log of the smooth force relative to it"},
                   {"log_drag", kNeedsForce | kNeedsArea, kPace,
                    "log of smooth force over area^1.5; for an object that "
                    "slides this is density times friction and does not "
                    "depend on its size"}},
          .standard = true,
          .make = MakeCues<Extremes>};
}

}  // namespace tactus::internal
