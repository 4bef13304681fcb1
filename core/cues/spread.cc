// How far the load of the contact's region reaches.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

// Floor of a standard deviation, m.
constexpr double kSpreadFloor = 1e-5;

class Spread final : public CueComputation {
 public:
  explicit Spread(const CueContext& context)
      : window_(context.Window(kSmoothS)) {}
  void Reset() override {
    rows_ = {};
    columns_ = {};
  }
  void Step(const CueStep& step) override {
    const double weight = step.Weight(window_);
    rows_.Step(step.sample.spread.rows, weight);
    columns_.Step(step.sample.spread.columns, weight);
  }
  void Derive(std::span<double> cues) const override {
    constexpr double kFloor = kSpreadFloor * kSpreadFloor;
    cues[0] = 0.5 * LogAbove(rows_.value, kFloor);
    cues[1] = 0.5 * LogAbove(columns_.value, kFloor);
  }

 private:
  double window_;
  RunningMean rows_;
  RunningMean columns_;
};

}  // namespace

CueGroup SpreadCues() {
  constexpr unsigned kNeeds = kNeedsForce | kNeedsArea;
  constexpr unsigned kHolds = kPace | kLoad | kStiffness;
  return {.name = "spread",
          .rows = {{"log_row_spread", kNeeds, kHolds,
                    "log of the standard deviation of the region's load "
                    "across the rows, in metres"},
                   {"log_column_spread", kNeeds, kHolds,
                    "`log_row_spread` across the columns"}},
          .sources = kFromSpread,
          .make = MakeCues<Spread>};
}

}  // namespace tactus::internal
