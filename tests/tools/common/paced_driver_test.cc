#include "tools/common/paced_driver.h"

#include "client/drivers/sim_driver.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

// Time passes only while somebody sleeps.
class SleepingClock : public Clock {
 public:
  int64_t NowNs() override { return now_ns_; }
  void SleepNs(int64_t duration_ns) override { now_ns_ += duration_ns; }

 private:
  int64_t now_ns_ = 7'000'000'000;
};

TEST(PacedDriverTest, FramesComeWhenTheyAreDue) {
  SleepingClock clock;
  SimDriver sim({.seed = 2}, 2, {});
  PacedDriver driver(&sim, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  uint64_t frames = 0;
  int pauses = 0;
  int ends = 0;
  int64_t last_ns = 0;
  while (true) {
    const int64_t before_ns = clock.NowNs();
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok());
    ends += *result == ReadResult::kEndOfTrial;
    EXPECT_LE(clock.NowNs() - before_ns, 100'000'000);
    if (*result == ReadResult::kEndOfData) break;
    if (*result != ReadResult::kFrame) continue;
    EXPECT_EQ(frame.capture_time_ns, clock.NowNs());
    if (frames > 0 && frame.capture_time_ns - last_ns > 500'000'000) ++pauses;
    last_ns = frame.capture_time_ns;
    ++frames;
  }
  EXPECT_EQ(pauses, 1);
  EXPECT_EQ(ends, 2);
  EXPECT_GT(frames, 300u);
  const DriverStatistics statistics = driver.Statistics();
  EXPECT_EQ(statistics.frames, frames);
  EXPECT_EQ(statistics.lost, 0u);
  EXPECT_NEAR(statistics.rate_hz, 100, 0.1);
}

}  // namespace
}  // namespace tactus::internal::client
