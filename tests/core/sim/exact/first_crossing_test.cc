#include "core/sim/exact/first_crossing.h"

#include <cmath>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/sim/random_scenes.h"

namespace tactus::internal {
namespace {

double Value(const ModalFunction& f, double t) {
  double value = f.start + t * (f.slope + f.curvature * t / 2);
  for (int i = 0; i < 2; ++i) {
    if (f.pairs[i]) value += f.pairs[i]->Change(f.states[i], t).value;
  }
  return value;
}

TEST(FirstCrossingTest, FindsHandComputedTimes) {
  ModalFunction line;
  line.start = 3;
  line.slope = -2;
  EXPECT_NEAR(FirstCrossing(line, 10), 1.5, 1e-15);
  EXPECT_GT(FirstCrossing(line, 1.4), 1.4);
  // 1 + t - t^2 = 0.
  ModalFunction parabola;
  parabola.start = 1;
  parabola.slope = 1;
  parabola.curvature = -2;
  EXPECT_NEAR(FirstCrossing(parabola, 10), (1 + std::sqrt(5)) / 2, 1e-14);
  // cos(3 t), from 1.
  const DampedPair swing(0, 9);
  ModalFunction cosine;
  cosine.start = 1;
  cosine.pairs[0] = &swing;
  cosine.states[0] = {1, 0};
  EXPECT_NEAR(FirstCrossing(cosine, 10), std::acos(-1) / 6, 1e-14);
}

TEST(FirstCrossingTest, LeavesZeroUpwards) {
  // sin(3 t): 0 at the start, next at pi / 3.
  const DampedPair swing(0, 9);
  ModalFunction sine;
  sine.pairs[0] = &swing;
  sine.states[0] = {0, 3};
  EXPECT_NEAR(FirstCrossing(sine, 10), std::acos(-1) / 3, 1e-14);
  // Falls at once.
  EXPECT_NEAR(FirstCrossing(sine.Negated(), 10), 0, 1e-9);
}

// A ring of 1e5 rad/s on a slow line dips below zero for 1e-7 s first after
// 0.7 s: found at that very dip, and passed if the dip stays above.
TEST(FirstCrossingTest, DoesNotSkipAShortDip) {
  const double rate = 1e5;
  const DampedPair ring(0, rate * rate);
  ModalFunction f;
  f.start = 1 + 1e-3;
  f.slope = 0;
  f.pairs[1] = &ring;
  f.states[1] = {1e-3, 0};
  f.slope = -1e-3 / 0.7;
  // f = 1 - t 1e-3 / 0.7 + 1e-3 cos(rate t): never below 0 within 2 s.
  EXPECT_GT(FirstCrossing(f, 2), 2);
  // Lowered so that 1e-3 (1 - t / 0.7) + 1e-3 (1 + cos) crosses only in the
  // dips after 0.7 s.
  f.start = 1e-3 + 2e-3;
  const double first = FirstCrossing(f, 2);
  const double dip = std::fmod(first * rate, 2 * std::acos(-1));
  EXPECT_GT(first, 0.7);
  EXPECT_LT(first, 0.7 + 2 * 2 * std::acos(-1) / rate);
  EXPECT_NEAR(dip, std::acos(-1), 0.02);
}

// Against a dense scan, which may only ever be later.
TEST(FirstCrossingTest, NeverLaterThanADenseScan) {
  Random random(5);
  int crossings = 0;
  for (int i = 0; i < 1000; ++i) {
    const double slow_rate = LogUniform(random, 1, 30);
    const double fast_rate = slow_rate * LogUniform(random, 1, 100);
    const DampedPair slow(slow_rate * random.Uniform(0, 3),
                          slow_rate * slow_rate);
    const DampedPair fast(fast_rate * random.Uniform(0, 0.1),
                          fast_rate * fast_rate);
    ModalFunction f;
    f.pairs = {&slow, &fast};
    f.states = {PairState{random.Gaussian(), random.Gaussian() * slow_rate},
                PairState{random.Gaussian(), random.Gaussian() * fast_rate}};
    f.start = std::abs(random.Gaussian()) * 3;
    f.slope = random.Gaussian();
    f.curvature = random.Gaussian();
    const double found = FirstCrossing(f, 1);
    constexpr int kPoints = 3000;
    double scanned = 2;
    for (int k = 1; k <= kPoints && scanned > 1; ++k) {
      const double t = static_cast<double>(k) / kPoints;
      if (Value(f, t) < 0) scanned = t;
    }
    if (scanned <= 1) {
      ++crossings;
      ASSERT_LE(found, scanned);
    }
    if (found <= 1) {
      EXPECT_NEAR(Value(f, found), 0, 1e-11) << i;
      // Nothing before it.
      for (int k = 1; k < 1000; ++k) {
        ASSERT_GT(Value(f, found * k / 1000), -1e-11) << i;
      }
    }
  }
  EXPECT_GT(crossings, 200);
}

}  // namespace
}  // namespace tactus::internal
