#include "core/sim/exact/bounce_series.h"

#include <cmath>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// A sequence of changes that a polynomial of degree 5 gives exactly.
BounceChange ChangeAt(double n) {
  BounceChange change = {};
  change[kTime] = 1 + 1e-3 * n;
  change[kLag] = 1 - n / 100 + n * n / 1e5;
  change[kApproach] = std::pow(n / 500, 5);
  return change;
}

BounceChange Added(int from, int to) {
  BounceChange sum = {};
  for (int n = from; n < to; ++n) {
    const BounceChange change = ChangeAt(n);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += change[i];
  }
  return sum;
}

TEST(BounceSeriesTest, LeadsOverAStrideAsOneByOne) {
  int now = 0;
  BounceSeries series(ChangeAt(now));
  while (series.stride() < 16) {
    now += static_cast<int>(series.stride());
    const BounceChange miss = series.Miss(ChangeAt(now));
    if (series.stride() > 1) {
      EXPECT_NEAR(miss[kApproach], 0, 1e-9);
    }
    series.Add(ChangeAt(now));
    series.Double();
  }
  for (int m = 0; m <= 16; ++m) {
    const BounceChange got = series.Sum(m / 16.0);
    const BounceChange want = Added(now, now + m);
    for (size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i], want[i], 1e-9 * (1 + std::abs(want[i]))) << m;
    }
    if (m > 0) {
      EXPECT_NEAR(series.ShareAt(want[kTime]), m / 16.0, 1e-12);
    }
  }
}

TEST(BounceSeriesTest, NeedsToKnowEnoughToDouble) {
  BounceSeries series(ChangeAt(0));
  for (int n = 1; n < 2 * BounceSeries::kTerms - 1; ++n) {
    EXPECT_FALSE(series.Double());
    series.Add(ChangeAt(n));
  }
  EXPECT_TRUE(series.Double());
  EXPECT_EQ(series.stride(), 2);
  EXPECT_FALSE(series.Double());
}

}  // namespace
}  // namespace tactus::internal
