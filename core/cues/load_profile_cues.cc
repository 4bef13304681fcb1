// Where on the skin the load is.
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class LoadProfileValues final : public CueComputation {
 public:
  explicit LoadProfileValues(const CueContext&) {}
  void Reset() override { profile_ = {}; }
  void Step(const CueStep& step) override {
    std::ranges::transform(step.sample.profile, profile_.begin(), ClampSample);
  }
  void Derive(std::span<double> cues) const override {
    std::ranges::copy(profile_, cues.begin());
  }

 private:
  LoadProfile profile_ = {};
};

}  // namespace

CueGroup LoadProfileCues() {
  constexpr absl::string_view kMeaning =
      "the load profile: root of the load on a band of the whole skin";
  return {.name = "load_profile",
          .rows = {{"row_load", kNeedsForce, kPace, kMeaning, kRowBands},
                   {"column_load", kNeedsForce, kPace, kMeaning, kColumnBands}},
          .sources = kFromProfile,
          .make = MakeCues<LoadProfileValues>};
}

}  // namespace tactus::internal
