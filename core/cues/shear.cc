// What pulls along the skin on the contact's region. Only a skin of three axes
// feels it.
#include <cmath>

#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

constexpr double kShortS = 0.1;
constexpr double kLongS = 0.4;

// A force along the skin.
struct Pull {
  double first = 0;
  double second = 0;

  double size() const { return std::hypot(first, second); }
  void Step(const Pull& pull, double weight) {
    first += weight * (pull.first - first);
    second += weight * (pull.second - second);
  }
};

class ShearComputation final : public CueComputation {
 public:
  explicit ShearComputation(const CueContext& context)
      : smooth_frames_(context.Window(kSmoothS)),
        short_frames_(context.Window(kShortS)),
        long_frames_(context.Window(kLongS)) {}
  void Reset() override { state_ = {}; }
  void Step(const CueStep& step) override {
    State& s = state_;
    const Pull pull = {ClampSample(step.sample.shear.first),
                       ClampSample(step.sample.shear.second)};
    const double force = std::abs(step.x[kNetForce]);
    double change = 0;
    if (step.frames > 1) {
      const Pull moved = {pull.first - s.last.first,
                          pull.second - s.last.second};
      change = moved.first * moved.first + moved.second * moved.second;
    }
    s.last = pull;
    s.smooth.Step(pull, step.Weight(smooth_frames_));
    s.force.Step(force, step.Weight(smooth_frames_));
    const double size = pull.size();
    const auto take = [&](Window& window, double weight) {
      window.pull.Step(pull, weight);
      window.size.Step(size, weight);
      window.force.Step(force, weight);
    };
    s.change.Step(change, step.Weight(short_frames_));
    take(s.in_short, step.Weight(short_frames_));
    take(s.in_long, step.Weight(long_frames_));
  }
  void Derive(std::span<double> cues) const override {
    const State& s = state_;
    const double size = s.smooth.size();
    cues[0] = LogAbove(size, kForceFloor);
    cues[1] = LogRatio(size, s.force.value);
    cues[2] = Ratio(s.smooth.first, size);
    cues[3] = Ratio(s.smooth.second, size);
    const Pull& now = s.in_short.pull;
    const Pull& before = s.in_long.pull;
    cues[4] = Ratio(now.first * before.first + now.second * before.second,
                    now.size() * before.size());
    cues[5] = LogRatio(s.in_short.size.value, s.in_long.size.value);
    cues[6] = LogRatio(s.in_short.size.value, s.in_short.force.value) -
              LogRatio(s.in_long.size.value, s.in_long.force.value);
    const double mean = std::max(s.in_short.size.value, kForceFloor);
    cues[7] = 0.5 * std::log(s.change.value / (mean * mean) +
                             kRippleFloor * kRippleFloor);
  }

 private:
  struct Window {
    Pull pull;
    RunningMean size;
    RunningMean force;
  };
  struct State {
    Pull last;
    Pull smooth;
    RunningMean force;
    // Squared change from frame to frame, in the short window.
    RunningMean change;
    Window in_short;
    Window in_long;
  };

  static double LogRatio(double x, double y) {
    return LogAbove(x, kForceFloor) - LogAbove(y, kForceFloor);
  }

  double smooth_frames_;
  double short_frames_;
  double long_frames_;
  State state_;
};

}  // namespace

CueGroup ShearCues() {
  constexpr unsigned kForces = kLoad | kStiffness;
  return {
      .name = "shear",
      .rows = {{"log_shear", kNeedsForce, kPace,
                "log of the size of the region's shear, in the layout's unit"},
               {"log_shear_ratio", kNeedsForce, kPace | kForces,
                "log of that size over the net force"},
               {"shear_cosine", kNeedsForce, kPace | kForces,
                "direction of the shear: its first part over its size"},
               {"shear_sine", kNeedsForce, kPace | kForces,
                "direction of the shear: its second part over its size"},
               {"shear_turn", kNeedsForce, kForces,
                "cosine of the angle between the mean shears of 0.1 s and of "
                "0.4 s"},
               {"log_shear_rate", kNeedsForce, kForces,
                "log of the mean size in 0.1 s over that in 0.4 s"},
               {"log_shear_ratio_rate", kNeedsForce, kForces,
                "`log_shear_ratio` of means over 0.1 s less that over 0.4 s"},
               {"shear_tremor_short", kNeedsForce, kForces,
                "log of the root mean square change of the shear from frame to "
                "frame, over its mean size, in the window"}},
      .sources = kFromShear,
      .make = MakeCues<ShearComputation>};
}

}  // namespace tactus::internal
