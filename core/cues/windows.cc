// What happens in the last 0.1 s, and in the last 0.4 s.
#include <array>
#include <vector>

#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

// Below these, signed logarithms are nearly linear: N/m, fractions.
constexpr double kStiffnessKnee = 1e3;
constexpr double kResponseKnee = 1e-5;

class WindowMoments : public CueComputation {
 public:
  explicit WindowMoments(double window) : window_(window) {}
  void Reset() override { moments_ = {}; }
  void Step(const CueStep& step) override {
    moments_.Step(step.x, step.Weight(window_));
  }
  void Derive(std::span<double> cues) const override {
    const RunningMoments& m = moments_;
    cues[0] = SignedLog(Slope(m.force_motion, kContactMotion), kStiffnessKnee);
    cues[1] = Ripple(kNetForce, kForceFloor);
    cues[2] = Ripple(kContactMotion, kMotionFloor);
    cues[3] = Ripple(kContactArea, kAreaFloor);
    cues[4] = SignedLog(Slope(m.force_area, kNetForce) * m.mean[kNetForce] /
                            std::max(m.mean[kContactArea], kAreaFloor),
                        kResponseKnee);
  }

 private:
  // Log of deviation over mean.
  double Ripple(int feature, double floor) const {
    const double mean = std::max(std::abs(moments_.mean[feature]), floor);
    const double relative = moments_.variance[feature] / (mean * mean);
    return 0.5 * std::log(relative + kRippleFloor * kRippleFloor);
  }
  // Covariance over variance; 0 while the feature does not change.
  double Slope(double covariance, int feature) const {
    const double rounding = kRoundingFraction * moments_.mean[feature];
    const double variance = moments_.variance[feature];
    return variance > rounding * rounding ? covariance / variance : 0;
  }

  double window_;
  RunningMoments moments_;
};

class ShortWindow final : public WindowMoments {
 public:
  explicit ShortWindow(const CueContext& context)
      : WindowMoments(context.Window(0.1)) {}
};

class LongWindow final : public WindowMoments {
 public:
  explicit LongWindow(const CueContext& context)
      : WindowMoments(context.Window(0.4)) {}
};

constexpr absl::string_view kWindowStiffness =
    "slope of force on motion over the window, signed log; 0 while the motion "
    "rests";
constexpr absl::string_view kWindowRipple =
    "log of deviation over mean in the window";
constexpr absl::string_view kWindowResponse =
    "relative change of area over relative change of force in the window, "
    "signed log; 0 while the force rests";

// The rows of a window, in the order of WindowMoments::Derive.
std::vector<CueRow> WindowRows(const std::array<absl::string_view, 5>& names) {
  constexpr unsigned kHolds = kLoad | kStiffness;
  return {
      {names[0], kNeedsForce | kNeedsMotion, kPace | kLoad, kWindowStiffness},
      {names[1], kNeedsForce, kHolds, kWindowRipple},
      {names[2], kNeedsMotion, kHolds, kWindowRipple},
      {names[3], kNeedsArea, kHolds, kWindowRipple},
      {names[4], kNeedsForce | kNeedsArea, kPace | kHolds, kWindowResponse}};
}

}  // namespace

CueGroup ShortWindowCues() {
  return {.name = "short_window",
          .rows = WindowRows({"stiffness_short", "force_ripple_short",
                              "motion_ripple_short", "area_ripple_short",
                              "area_response_short"}),
          .standard = true,
          .make = MakeCues<ShortWindow>};
}

CueGroup LongWindowCues() {
  return {.name = "long_window",
          .rows = WindowRows({"stiffness_long", "force_ripple_long",
                              "motion_ripple_long", "area_ripple_long",
                              "area_response_long"}),
          .standard = true,
          .make = MakeCues<LongWindow>};
}

}  // namespace tactus::internal
