// How the net force trembles. Only a skin with little noise feels it.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class Tremor final : public CueComputation {
 public:
  explicit Tremor(const CueContext& context)
      : short_frames_(context.Window(0.1)), long_frames_(context.Window(0.4)) {}
  void Reset() override { state_ = {}; }
  void Step(const CueStep& step) override {
    State& s = state_;
    const double force = step.x[kNetForce];
    const double change = step.frames == 1 ? 0 : force - s.last_force;
    const double turn = step.frames <= 2 ? 0 : change - s.last_change;
    const auto take = [&](Squares& squares, double weight) {
      squares.level.Step(force, weight);
      squares.change.Step(change * change, weight);
      squares.turn.Step(turn * turn, weight);
    };
    take(s.in_short, step.Weight(short_frames_));
    take(s.in_long, step.Weight(long_frames_));
    s.last_force = force;
    s.last_change = change;
  }
  void Derive(std::span<double> cues) const override {
    Derive(state_.in_short, cues.subspan(0, 2));
    Derive(state_.in_long, cues.subspan(2, 2));
  }

 private:
  // Mean, and mean squares of the change from frame to frame and of the change
  // of that change.
  struct Squares {
    RunningMean level;
    RunningMean change;
    RunningMean turn;
  };
  struct State {
    double last_force = 0;
    double last_change = 0;
    Squares in_short;
    Squares in_long;
  };

  static void Derive(const Squares& squares, std::span<double> cues) {
    const double mean = std::max(std::abs(squares.level.value), kForceFloor);
    const double rounding =
        kRoundingFraction * mean * (kRoundingFraction * mean);
    const double change = squares.change.value;
    cues[0] =
        0.5 * std::log(change / (mean * mean) + kRippleFloor * kRippleFloor);
    cues[1] =
        0.5 * std::log((squares.turn.value + rounding) / (change + rounding));
  }

  double short_frames_;
  double long_frames_;
  State state_;
};

constexpr absl::string_view kTremorMeaning =
    "log of the root mean square change of the force from frame to frame, "
    "over its mean, in the window";
// Hjorth, Electroencephalography and Clinical Neurophysiology 29, 1970.
constexpr absl::string_view kPitchMeaning =
    "log of the root mean square change of that change, over the root mean "
    "square of the change: high if the force trembles fast, whatever its "
    "amplitude (Hjorth's mobility)";

}  // namespace

CueGroup TremorCues() {
  constexpr unsigned kHolds = kLoad | kStiffness;
  return {.name = "tremor",
          .rows = {{"force_tremor_short", kNeedsForce, kHolds, kTremorMeaning},
                   {"force_pitch_short", kNeedsForce, kHolds, kPitchMeaning},
                   {"force_tremor_long", kNeedsForce, kHolds, kTremorMeaning},
                   {"force_pitch_long", kNeedsForce, kHolds, kPitchMeaning}},
          .make = MakeCues<Tremor>};
}

}  // namespace tactus::internal
