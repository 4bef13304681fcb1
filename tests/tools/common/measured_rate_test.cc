#include "tools/common/measured_rate.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

// 200 frames at `hz`, with jitter, losses and a pause.
MeasuredRate RateAt(double hz) {
  Random random(3);
  MeasuredRate rate;
  SkinFrame frame;
  double time_s = 1;
  for (int i = 0; i < 200; ++i) {
    const bool lost = i % 10 == 5;
    // As of a driver that was configured for twice the rate.
    frame.missing_before = lost ? 3 : 1;
    time_s += (lost ? 2 : 1) / hz;
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

TEST(MeasuredRateTest, FramesMayComeInPairs) {
  MeasuredRate rate;
  SkinFrame frame;
  for (int i = 0; i < 100; ++i) {
    if (i % 2 == 0) frame.capture_time_ns += 66'000'000;
    frame.capture_time_ns += 333'333;
    rate.Add(frame);
  }
  EXPECT_NEAR(rate.hz(), 30, 0.5);
}

// An adapter had some frames already when it was opened.
TEST(MeasuredRateTest, ABurstAtTheBeginningDoesNotCount) {
  MeasuredRate rate;
  SkinFrame frame;
  for (int i = 0; i < 50; ++i) {
    frame.capture_time_ns += i < 5 ? 100'000 : 33'333'333;
    rate.Add(frame);
  }
  EXPECT_NEAR(rate.hz(), 30, 0.1);
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
}  // namespace tactus::internal::client
