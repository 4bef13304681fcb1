// The whole skin without places (core/taxels/whole_skin.h).
#include "core/cues/cue_group.h"
#include "core/taxels/whole_skin.h"

namespace tactus::internal {
namespace {

class WholeSkinNumbers final : public CueComputation {
 public:
  WholeSkinNumbers(int taxels, double sample_rate_hz)
      : tracker_(taxels, sample_rate_hz) {}
  void Reset() override { tracker_.Reset(); }
  void Step(const CueStep& step) override { tracker_.Step(step.sample.loads); }
  void Derive(std::span<double> cues) const override {
    const WholeSkinTracker::Numbers& n = tracker_.numbers();
    const double values[] = {
        n.root_force,   n.root_taxels, n.peak_share,         n.log_spread,
        n.force_rate,   n.taxels_rate, n.peak_share_rate,    n.spread_rate,
        n.change_short, n.change_long, n.change_since_onset, n.log_travel};
    std::ranges::copy(values, cues.begin());
  }

 private:
  WholeSkinTracker tracker_;
};

std::unique_ptr<CueComputation> MakeWholeSkin(const CueContext& context) {
  if (context.embedding == nullptr || context.embedding->taxels == 0) {
    return nullptr;
  }
  return std::make_unique<WholeSkinNumbers>(context.embedding->taxels,
                                            context.sample_rate_hz);
}

}  // namespace

CueGroup WholeSkinCues() {
  constexpr unsigned kF = kNeedsForce;
  constexpr unsigned kFA = kNeedsForce | kNeedsArea;
  constexpr unsigned kFM = kNeedsForce | kNeedsMotion;
  constexpr unsigned kHolds = kLoad | kStiffness;
  constexpr absl::string_view kRate =
      "the cue without `_rate`, less its mean over 0.4 s";
  return {
      .name = "whole_skin",
      .rows = {{"skin_force", kF, kPace, "root of the load on the whole skin"},
               {"skin_taxels", kFA, kHolds | kPace,
                "root of the number of touched taxels"},
               {"skin_peak_share", kF, kHolds | kPace,
                "the largest taxel's share of the load"},
               {"skin_spread", kFA, kHolds | kPace,
                "log of the number of taxels that would share the load "
                "equally"},
               {"skin_force_rate", kF, 0, kRate},
               {"skin_taxels_rate", kFA, kHolds, kRate},
               {"skin_peak_share_rate", kF, kHolds, kRate},
               {"skin_spread_rate", kFA, kHolds, kRate},
               {"skin_change_short", kFM, kHolds,
                "log of the fraction of the load that has moved away from the "
                "mean pattern of the last 0.1 s"},
               {"skin_change_long", kFM, kHolds,
                "`skin_change_short` for 0.4 s"},
               {"skin_change_since_onset", kFM, kHolds,
                "`skin_change_short` for the first 0.1 s"},
               {"skin_travel", kFM, kHolds,
                "log of the sum of these changes since onset"}},
      .sources = kFromTaxels,
      .make = MakeWholeSkin};
}

}  // namespace tactus::internal
