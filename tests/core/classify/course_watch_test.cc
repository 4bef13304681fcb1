#include "core/classify/course_watch.h"

#include <cmath>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Force grows by the root of time and ends in a plateau, as pushed objects do;
// from frame `slip` on the object follows the arm. In units of `scale`, with
// noise of 1 % of the plateau.
ContactSample Pushed(int t, int slip, double scale, Random& random) {
  const double force = std::sqrt(std::min(t, 400) / 400.0);
  const double before = 0.002 * t / 400.0;
  const double motion = t < slip ? before : before + 0.0002 * (t - slip);
  const auto noisy = [&](double value, double size) {
    return scale * (value + 0.01 * size * random.Gaussian());
  };
  ContactSample sample;
  sample.net_force = noisy(force, 1);
  sample.features = {sample.net_force, noisy(1e-3, 1e-3), noisy(motion, 0.01)};
  return sample;
}

TEST(CourseWatchTest, ASlipIsSeenSoonAndNoiseIsNot) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    int seen = 0;
    int false_alarms = 0;
    double frames = 0;
    Random random(7);
    CourseWatch watch;
    for (int contact = 0; contact < 100; ++contact) {
      watch.Reset();
      const int slip = 200 + contact;
      for (int t = 1; t <= slip + 40; ++t) {
        if (!watch.Step(Pushed(t, slip, scale, random))) continue;
        // The start, where nothing has a course yet.
        if (t >= 50 && t < slip) ++false_alarms;
        if (t >= slip) {
          ++seen;
          frames += t - slip;
          break;
        }
        watch.Restart();
      }
    }
    EXPECT_EQ(seen, 100) << scale;
    EXPECT_LT(frames / seen, 10) << scale;
    // There are about 20,000 frames.
    EXPECT_LT(false_alarms, 40) << scale;
  }
}

TEST(CourseWatchTest, EachOfItsSignalsIsWatched) {
  const auto base = [] {
    ContactSample sample;
    sample.net_force = 1;
    sample.features = {1, 1e-3, 0};
    return sample;
  };
  using Change = void (*)(ContactSample&);
  for (const Change change :
       {Change([](ContactSample& s) { s.net_force = 2; }),
        Change([](ContactSample& s) { s.features[1] = 2e-3; }),
        Change([](ContactSample& s) { s.features[2] = 1e-3; }),
        Change([](ContactSample& s) {
          s.shear = {0, -0.5};
        })}) {
    CourseWatch watch;
    for (int t = 0; t < 50; ++t) EXPECT_FALSE(watch.Step(base()));
    ContactSample changed = base();
    change(changed);
    bool left = false;
    for (int t = 0; t < 10; ++t) left |= watch.Step(changed);
    EXPECT_TRUE(left);
  }
}

TEST(CourseWatchTest, ARestartForgetsWhatWasSeen) {
  CourseWatch watch;
  ContactSample sample;
  int fired = 0;
  for (int t = 0; t < 100; ++t) {
    sample.net_force = t < 50 ? 1 : 2;
    if (watch.Step(sample)) {
      ++fired;
      watch.Restart();
    }
  }
  // Once or twice for one step, and never again: 2 is the course now.
  EXPECT_GE(fired, 1);
  EXPECT_LE(fired, 4);
}

}  // namespace
}  // namespace tactus::internal
