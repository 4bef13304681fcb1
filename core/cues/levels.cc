// How large the smooth features are, and force and motion over one another.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class Levels final : public CueComputation {
 public:
  explicit Levels(const CueContext& context)
      : rate_(context.sample_rate_hz), window_(context.Window(kSmoothS)) {}
  void Reset() override { peak_ = {}; }
  void Step(const CueStep& step) override {
    peak_.Step(ClampSample(step.sample.features[kNetForce]),
               step.Weight(window_));
    smooth_ = step.smooth;
    seconds_ = static_cast<double>(step.frames_since_onset) / rate_;
  }
  void Derive(std::span<double> cues) const override {
    const double log_force = LogAbove(smooth_[kNetForce], kForceFloor);
    const double log_motion = LogAbove(smooth_[kContactMotion], kMotionFloor);
    const double log_time = std::log(seconds_);
    cues[0] = LogAbove(peak_.value, kForceFloor);
    cues[1] = log_force;
    cues[2] = LogAbove(smooth_[kContactArea], kAreaFloor);
    cues[3] = log_motion;
    cues[4] = log_time;
    cues[5] = log_motion - log_time;
    cues[6] = log_force - log_motion;
  }

 private:
  double rate_;
  double window_;
  RunningMean peak_;
  FeatureVector smooth_ = {};
  double seconds_ = 1;
};

}  // namespace

CueGroup LevelCues() {
  return {.name = "levels",
          .rows = {{"log_peak", kNeedsForce, kPace,
                    "log of the smooth force of the largest taxel"},
                   {"log_force", kNeedsForce, kPace, "log of the smooth force"},
                   {"log_area", kNeedsArea, kPace | kLoad | kStiffness,
                    "log of the smooth area"},
                   {"log_motion", kNeedsMotion, kPace | kStiffness,
                    "log of the smooth motion"},
                   {"log_time", 0, kLoad | kStiffness,
                    "log of the seconds since onset"},
                   {"log_speed", kNeedsMotion, kStiffness,
                    "`log_motion - log_time`"},
                   {"log_stiffness", kNeedsForce | kNeedsMotion, kPace | kLoad,
                    "`log_force - log_motion`"}},
          .standard = true,
          .make = MakeCues<Levels>};
}

}  // namespace tactus::internal
