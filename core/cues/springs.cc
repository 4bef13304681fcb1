// Springs that are fitted to the whole contact: while an object does not slide,
// it is one (paper, eq. 5).
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

// Floor of the fraction of variance that is not explained.
constexpr double kMisfitFloor = 1e-4;

// Log of the fraction of variance that `product` does not explain.
double Misfit(double product, double x, double y) {
  const double explained = Ratio(product, x) * Ratio(product, y);
  return std::log(1 + kMisfitFloor - std::clamp(explained, 0.0, 1.0));
}

class Springs final : public CueComputation {
 public:
  explicit Springs(const CueContext&) {}
  void Reset() override { state_ = {}; }
  void Step(const CueStep& step) override {
    State& s = state_;
    const FeatureVector& x = step.x;
    const double weight = 1 / step.frames;
    s.contact.Step(x, weight);
    s.force_motion.Step(x[kNetForce] * x[kContactMotion], weight);
    s.motion_motion.Step(x[kContactMotion] * x[kContactMotion], weight);
    s.force_force.Step(x[kNetForce] * x[kNetForce], weight);
    const double force_motion =
        std::max(s.force_motion.value, kForceFloor * kMotionFloor);
    const double motion_motion =
        std::max(s.motion_motion.value, kMotionFloor * kMotionFloor);
    // Compares the ratios without a division.
    if (step.frames == 1 || force_motion * s.stiffest_motion_motion >
                                s.stiffest_force_motion * motion_motion) {
      s.stiffest_force_motion = force_motion;
      s.stiffest_motion_motion = motion_motion;
    }
  }
  void Derive(std::span<double> cues) const override {
    const State& s = state_;
    cues[0] = LogAbove(s.force_motion.value, kForceFloor * kMotionFloor) -
              LogAbove(s.motion_motion.value, kMotionFloor * kMotionFloor);
    cues[1] =
        std::log(s.stiffest_force_motion) - std::log(s.stiffest_motion_motion);
    cues[2] = Misfit(s.force_motion.value, s.motion_motion.value,
                     s.force_force.value);
    const RunningMoments& all = s.contact;
    cues[3] = LogAbove(all.variance[kNetForce], kForceFloor * kForceFloor) -
              LogAbove(all.force_motion, kForceFloor * kMotionFloor);
    cues[4] = Misfit(all.force_motion, all.variance[kContactMotion],
                     all.variance[kNetForce]);
  }

 private:
  struct State {
    RunningMoments contact;
    // Mean products, for the spring through the origin.
    RunningMean force_motion;
    RunningMean motion_motion;
    RunningMean force_force;
    // The mean products at the frame where their ratio was largest.
    double stiffest_force_motion = 0;
    double stiffest_motion_motion = 0;
  };
  State state_;
};

}  // namespace

CueGroup SpringCues() {
  constexpr unsigned kBoth = kNeedsForce | kNeedsMotion;
  constexpr unsigned kHolds = kPace | kLoad;
  constexpr unsigned kHoldsAll = kPace | kLoad | kStiffness;
  return {.name = "springs",
          .rows = {{"log_spring", kBoth, kHolds,
                    "log of the stiffness of the spring through the origin "
                    "that fits the whole contact: sum of force x motion over "
                    "sum of motion^2"},
                   {"log_stiffest_spring", kBoth, kHolds,
                    "the largest `log_spring` so far"},
                   {"log_spring_misfit", kBoth, kHoldsAll,
                    "log of the fraction of force that this spring does not "
                    "explain, at least 1e-4"},
                   {"log_slope", kBoth, kHolds,
                    "`log_spring` of a spring with a free origin, by "
                    "regression of motion on force"},
                   {"log_slope_misfit", kBoth, kHoldsAll,
                    "its `log_spring_misfit`"}},
          .standard = true,
          .make = MakeCues<Springs>};
}

}  // namespace tactus::internal
