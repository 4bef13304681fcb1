#include "client/tools/common/measured_rate.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

// 200 frames at `hz`, with jitter, losses and a pause.
MeasuredRate RateAt(double hz) {
  Random random(3);
  MeasuredRate rate;
  SkinFrame frame;
  double time_s = 1;
  for (int i = 0; i < 200; ++i) {
    frame.missing_before = i % 10 == 5 ? 2 : 0;
    time_s += static_cast<double>(frame.missing_before + 1) / hz;
    if (i == 100) time_s += 5;
    frame.capture_time_ns =
        static_cast<int64_t>(1e9 * (time_s + 0.2 / hz * random.Uniform()));
    rate.Add(frame);
  }
  return rate;
}

TEST(MeasuredRateTest, LossesJitterAndPausesDoNotChangeIt) {
  EXPECT_NEAR(RateAt(30).hz(), 30, 0.3);
  EXPECT_NEAR(RateAt(100).hz(), 100, 1);
  EXPECT_EQ(MeasuredRate().hz(), 0);
}

TEST(MeasuredRateTest, MoreThanFivePercentIsRefused) {
  EXPECT_TRUE(RateAt(30).Check(30).ok());
  EXPECT_TRUE(RateAt(30).Check(31).ok());
  for (const double configured : {27., 33., 100.}) {
    EXPECT_EQ(ReasonOf(RateAt(30).Check(configured)), "INVALID_CONFIG")
        << configured;
  }
  EXPECT_FALSE(MeasuredRate().Check(30).ok());
}

}  // namespace
}  // namespace tactus::client
