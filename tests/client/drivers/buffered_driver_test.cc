#include "client/drivers/buffered_driver.h"

#include "client/drivers/driver_statistics.h"
#include "client/drivers/stuck_taxels.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Hands on frames as the test lets it.
class GatedDriver : public SkinDriver {
 public:
  // Lets `count` more frames out.
  void Let(int count) {
    const std::lock_guard lock(mutex_);
    allowed_ += count;
  }
  void Fail(const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    failure_ = status;
  }
  int taken() {
    const std::lock_guard lock(mutex_);
    return taken_;
  }
  // Waits until all frames that were let out have been read.
  void Drained() {
    while (true) {
      {
        const std::lock_guard lock(mutex_);
        // A read after the last frame has begun, so that one was handed on.
        if (taken_ == allowed_ && idle_) return;
      }
      std::this_thread::yield();
    }
  }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override { return SkinInfo(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    const std::lock_guard lock(mutex_);
    idle_ = taken_ == allowed_;
    if (idle_ && !failure_.ok()) return failure_;
    if (idle_) return ReadResult::kNoFrame;
    ++taken_;
    frame.capture_time_ns = taken_;
    frame.missing_before = taken_ == 3 ? 5 : 0;
    frame.u16.assign(4, static_cast<uint16_t>(taken_));
    return ReadResult::kFrame;
  }

 private:
  std::mutex mutex_;
  int allowed_ = 0;
  int taken_ = 0;
  bool idle_ = false;
  absl::Status failure_;
};

TEST(BufferedDriverTest, FramesComeInOrder) {
  GatedDriver gated;
  BufferedDriver driver(&gated, {.frames = 100});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  gated.Let(50);
  SkinFrame frame;
  uint64_t missing = 0;
  for (int i = 1; i <= 50;) {
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok());
    if (*result != ReadResult::kFrame) continue;
    EXPECT_EQ(frame.capture_time_ns, i);
    EXPECT_EQ(frame.u16[3], i);
    missing += frame.missing_before;
    ++i;
  }
  EXPECT_EQ(missing, 5u);
  EXPECT_EQ(*driver.Read(frame), ReadResult::kNoFrame);
  EXPECT_TRUE(driver.Deactivate().ok());
  EXPECT_EQ(gated.state(), DriverState::kInactive);
}

TEST(BufferedDriverTest, FramesThatNobodyReadsAreOverwrittenAndCounted) {
  for (const size_t size : {1u, 4u}) {
    GatedDriver gated;
    BufferedDriver driver(&gated, {.frames = size});
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    gated.Let(20);
    gated.Drained();
    SkinFrame frame;
    ASSERT_EQ(*driver.Read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.capture_time_ns, static_cast<int64_t>(21 - size));
    // Those overwritten, and those that the skin had lost before them.
    EXPECT_EQ(frame.missing_before, 20 - size + 5);
    EXPECT_EQ(driver.Statistics().overwritten, 20 - size);
  }
}

TEST(BufferedDriverTest, AnErrorComesAfterTheFramesBeforeIt) {
  GatedDriver gated;
  gated.Let(2);
  gated.Fail(IoError("can0", "no frame for 30 s"));
  BufferedDriver driver(&gated, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  EXPECT_EQ(*driver.Read(frame), ReadResult::kFrame);
  EXPECT_EQ(*driver.Read(frame), ReadResult::kFrame);
  EXPECT_EQ(ReasonOf(driver.Read(frame).status()), "IO");
  EXPECT_EQ(ReasonOf(driver.Read(frame).status()), "IO");
  EXPECT_TRUE(driver.Finalise().ok());
  EXPECT_EQ(gated.state(), DriverState::kFinalised);
}

TEST(FrameMeterTest, RateJitterLossesAndAges) {
  FrameMeter meter(20'000'000);
  int64_t time_ns = 1'000'000'000;
  uint64_t missing = 0;
  for (int i = 0; i < 400; ++i) {
    // Every other interval is 19 or 21 ms; three frames are lost once.
    time_ns += i % 2 == 0 ? 19'000'000 : 21'000'000;
    if (i == 200) time_ns += 3 * 20'000'000;
    missing += meter.Add(time_ns, time_ns + 2'000'000 + i * 1'000);
  }
  DriverStatistics statistics;
  meter.Write(statistics);
  EXPECT_EQ(statistics.frames, 400u);
  EXPECT_EQ(statistics.lost, 3u);
  EXPECT_EQ(missing, 3u);
  EXPECT_NEAR(statistics.rate_hz, 50, 0.02);
  EXPECT_NEAR(statistics.jitter_ms, 1, 0.01);
  EXPECT_NEAR(statistics.age_ms, 2.399, 1e-9);
  EXPECT_NEAR(statistics.longest_age_ms, 2.399, 1e-9);
}

TEST(StuckTaxelsTest, OnlyOneLongValueAboveZeroIsStuck) {
  StuckTaxels stuck(5);
  for (int i = 0; i < 4; ++i) {
    stuck.Add(std::vector<float>{0, 7, static_cast<float>(i), 3});
  }
  EXPECT_THAT(stuck.Taxels(), IsEmpty());
  stuck.Add(std::vector<float>{0, 7, 9, 3});
  EXPECT_THAT(stuck.Taxels(), ElementsAre(1, 3));
  stuck.Add(std::vector<float>{0, 7, 9, 4});
  EXPECT_THAT(stuck.Taxels(), ElementsAre(1));
}

}  // namespace
}  // namespace tactus::internal::client
