// A second kind of skin on the same buses and the same driver.
#include "client/drivers/xela/xela_skin.h"

#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/board_messages.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"

namespace tactus::client {
namespace {

using ::testing::HasSubstr;

// A patch that reads about 36,000 untouched; taxel 5 is pressed after 3 s.
class FakePatch : public CanPeer {
 public:
  int dead_taxel = -1;
  bool sending = false;

  void OnFrame(const CanFrame& frame, int64_t now_ns) override {
    const auto start = icub::ReadTransmit(frame, 1);
    if (!start) return;
    if (*start && !sending) next_ns_ = now_ns + 1'000'000;
    sending = *start;
    taxel_ = 0;
  }
  int64_t NextNs() override { return sending ? next_ns_ : kNever; }
  bool Emit(int64_t now_ns, CanFrame& frame) override {
    if (now_ns < NextNs()) return false;
    const int z = 36'000 + 10 * taxel_ +
                  (taxel_ == 5 && now_ns > 3'000'000'000 ? 700 : 0);
    frame = MakeCanFrame(0x710 + static_cast<uint32_t>(taxel_),
                         {0, 1, 2, 3, 4, static_cast<uint8_t>(z >> 8),
                          static_cast<uint8_t>(z & 0xFF)});
    frame.time_ns = next_ns_;
    do {
      next_ns_ += 200'000;
      if (++taxel_ == 16) {
        taxel_ = 0;
        next_ns_ += 10'000'000 - 16 * 200'000;
      }
    } while (taxel_ == dead_taxel);
    return true;
  }

 private:
  int taxel_ = 0;
  int64_t next_ns_ = 0;
};

TEST(XelaSkinTest, APatchStreamsThroughTheSameDriver) {
  ManualClock clock;
  FakePatch patch;
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout.taxels(), 16);
  EXPECT_EQ(info->sample_rate_hz, 100);
  EXPECT_FALSE(patch.sending);
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  int frames = 0;
  uint64_t missing = 0;
  int pressed = 0;
  while (clock.NowNs() < 4'000'000'000) {
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    ++frames;
    missing += frame.missing_before;
    for (int i = 0; i < 16; ++i) {
      EXPECT_TRUE(i == 5 || frame.u16[i] == 0) << i;
    }
    if (frame.u16[5] > 0) {
      ++pressed;
      EXPECT_EQ(frame.u16[5], 700);
    }
  }
  EXPECT_GT(frames, 200);
  EXPECT_NEAR(pressed, 100, 2);
  EXPECT_EQ(missing, 0u);
  EXPECT_TRUE(driver.Finalise().ok());
  EXPECT_FALSE(patch.sending);
}

TEST(XelaSkinTest, LossesRepetitionsAndBreaksAreThoseOfAnySkin) {
  ManualClock clock;
  FakePatch patch;
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  int count = 0;
  // Every fifth frame comes twice; one scan in ten lacks a frame.
  bus.copies = [&](const CanFrame&) {
    ++count;
    return count % 160 == 0 ? 0 : count % 5 == 0 ? 2 : 1;
  };
  SkinFrame frame;
  int frames = 0;
  uint64_t missing = 0;
  const int64_t begin_ns = clock.NowNs();
  while (clock.NowNs() < begin_ns + 10'000'000'000) {
    if (*driver.Read(frame) != ReadResult::kFrame) continue;
    ++frames;
    missing += frame.missing_before;
  }
  EXPECT_NEAR(frames, 900, 5);
  EXPECT_NEAR(static_cast<double>(missing), 100, 5);
  EXPECT_GE(driver.Statistics().incomplete, 95u);
  bus.broken = "bus-off";
  ASSERT_TRUE(driver.Read(frame).ok());
  while (*driver.Read(frame) != ReadResult::kFrame) continue;
  EXPECT_EQ(driver.Statistics().reconnects, 1u);
}

TEST(XelaSkinTest, ConfigureNamesWhatIsMissing) {
  ManualClock clock;
  FakePatch patch;
  MemoryBus bus(&patch, &clock);
  XelaSkin absent({.board = 2});
  CanSkinDriver none(&bus, &absent, {}, &clock);
  EXPECT_THAT(std::string(none.Configure().status().message()),
              HasSubstr("XELA patch: it sends nothing"));
  patch.dead_taxel = 9;
  XelaSkin lacking({.board = 1});
  CanSkinDriver driver(&bus, &lacking, {}, &clock);
  const absl::Status status = driver.Configure().status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("nothing comes from taxels 9"));
}

}  // namespace
}  // namespace tactus::client
