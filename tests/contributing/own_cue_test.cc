// The cue that CONTRIBUTING.md adds, with one file and one line of a table.
// symmetry_test.cc, which this program runs too, holds what it states.
#include <cmath>

#include "core/cues/cue_group.h"
#include "core/cues/cue_tracker.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(OwnCueTest, IsComputedAndListedBehindAllOthers) {
  const Cue cue = NamedCue("force_steadiness");
  EXPECT_EQ(static_cast<int>(cue), CueCount() - 1);
  EXPECT_EQ(CuesOfGroup("steadiness"), std::vector<Cue>{cue});
  CueTracker tracker(100, GroupOf(cue));
  for (int t = 1; t <= 100; ++t) {
    // Mean 3, deviation 1.
    const double force = t % 2 == 0 ? 4 : 2;
    tracker.Step({.features = {force, 1e-3, 1e-3}, .net_force = force}, t);
  }
  EXPECT_NEAR(tracker.value(cue), std::log(3.0), 1e-12);
}

TEST(OwnCueTest, ChangesNoOther) {
  EXPECT_EQ(StandardCues().size(), 30u);
  EXPECT_EQ(CueName(Cue::kMotion), "motion");
}

}  // namespace
}  // namespace tactus::internal
