// The slope of force on motion in the last 0.1 s grew without bound once the
// motion had rested for 4 s, as the centroid of a contact on a skin without
// poses does: a variance that decays to rounding divided a covariance that
// decays more slowly. Posteriors of the model without poses were wrong by
// 0.005.
#include <cmath>

#include "core/base/random.h"
#include "core/cues/cue_tracker.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(SlopeOfASignalAtRestTest, StaysSmall) {
  Random random(1);
  CueTracker tracker(100);
  for (int t = 1; t <= 5000; ++t) {
    const double force = 1 + 0.01 * random.Gaussian();
    const double motion = t <= 20 ? 0 : 0.0108 * 1.37;
    tracker.Step({{force, 1e-3, motion}, force}, t);
    if (t < 50) continue;
    // Real slopes of this noise are below 10 N/m, far below the knee.
    for (const Cue cue :
         {NamedCue("stiffness_short"), NamedCue("stiffness_long")}) {
      ASSERT_LT(std::abs(tracker.value(cue)), 0.01) << CueName(cue) << " " << t;
    }
  }
}

TEST(SlopeOfASignalAtRestTest, StaysSmallIfTheForceRests) {
  Random random(1);
  CueTracker tracker(100);
  for (int t = 1; t <= 5000; ++t) {
    const double force = t <= 20 ? 0.5 : 1.37;
    const double area = 1e-3 * (1 + 0.01 * random.Gaussian());
    tracker.Step({{force, area, 0.01}, force}, t);
    if (t < 50) continue;
    // In units of the knee, 1e-5.
    ASSERT_LT(std::abs(tracker.value(NamedCue("area_response_short"))), 15)
        << t;
  }
}

}  // namespace
}  // namespace tactus::internal
