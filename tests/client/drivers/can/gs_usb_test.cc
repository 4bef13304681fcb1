// GsUsb with the real libusb, against an adapter that umockdev plays.
#include "client/drivers/can/gs_usb.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "client/drivers/buffered_driver.h"
#include "client/drivers/can/can_error.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/can/mock_adapter.h"
#include "tools/fakeskin/icub_boards.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A bus on which only the test speaks.
class ListPeer : public CanPeer {
 public:
  void OnFrame(const CanFrame& frame, int64_t /*now_ns*/) override {
    const std::lock_guard lock(mutex_);
    heard_.push_back(frame);
  }
  int64_t NextNs() override { return kNever; }
  bool Emit(int64_t now_ns, CanFrame& frame) override {
    const std::lock_guard lock(mutex_);
    if (planned_.empty()) return false;
    frame = planned_.front();
    frame.time_ns = now_ns;
    planned_.pop_front();
    return true;
  }
  void Plan(const CanFrame& frame) {
    const std::lock_guard lock(mutex_);
    planned_.push_back(frame);
  }
  std::vector<CanFrame> heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  std::mutex mutex_;
  std::deque<CanFrame> planned_;
  std::vector<CanFrame> heard_;
};

class GsUsbTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* preloaded = std::getenv("LD_PRELOAD");
    if (preloaded == nullptr ||
        std::string(preloaded).find("umockdev") == std::string::npos) {
      GTEST_SKIP() << "runs under umockdev-wrapper only";
    }
  }

  ListPeer peer_;
  CanFrame frame_;
};

constexpr int64_t kLongNs = 2'000'000'000;

TEST_F(GsUsbTest, AnAdapterIsSetUpUsedAndReset) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  const absl::Status opened = bus.Open({});
  ASSERT_TRUE(opened.ok()) << opened;
  EXPECT_TRUE(adapter.started());
  EXPECT_EQ(adapter.mode_flags(), gs_usb::kHardwareStamps);
  EXPECT_EQ(adapter.bit_timing(),
            gs_usb::Bytes(gs_usb::BitTiming{1, 12, 2, 1, 3}));
  peer_.Plan(MakeCanFrame(0x4D5, {0x40, 1, 2, 3, 4, 5, 6, 7}));
  const auto received = bus.Receive(frame_, kLongNs);
  ASSERT_TRUE(received.ok()) << received.status();
  ASSERT_TRUE(*received);
  EXPECT_TRUE(frame_.SameAs(MakeCanFrame(0x4D5, {0x40, 1, 2, 3, 4, 5, 6, 7})));
  EXPECT_EQ(adapter.most_waiting(), 30u);
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x201, {7, 0})).ok());
  // The echo is no frame, and its flag no overflow.
  EXPECT_FALSE(*bus.Receive(frame_, 20'000'000));
  ASSERT_EQ(peer_.heard().size(), 1u);
  EXPECT_TRUE(peer_.heard()[0].SameAs(MakeCanFrame(0x201, {7, 0})));
  EXPECT_EQ(adapter.last_sent_size(), 20u);
  EXPECT_EQ(bus.counters().sent, 1u);
  EXPECT_EQ(bus.counters().received, 1u);
  EXPECT_EQ(bus.counters().overruns, 0u);
  bus.Close();
  EXPECT_FALSE(adapter.started());
  EXPECT_FALSE(adapter.claimed());
  // And again.
  ASSERT_TRUE(bus.Open({}).ok());
  EXPECT_TRUE(adapter.started());
}

// Such as those that stop a skin's boards.
TEST_F(GsUsbTest, FramesOnTheirWayReachTheBusBeforeTheReset) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x20D, {7, 0})).ok());
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x20C, {7, 0})).ok());
  bus.Close();
  EXPECT_FALSE(adapter.started());
  EXPECT_EQ(peer_.heard().size(), 2u);
}

TEST_F(GsUsbTest, TheKernelsDriverIsDetachedAndAttachedAgain) {
  MockAdapter adapter(&peer_, {.kernel_driver = true});
  {
    GsUsb bus({});
    ASSERT_TRUE(bus.Open({}).ok());
    EXPECT_FALSE(adapter.kernel_driver_attached());
    EXPECT_TRUE(adapter.claimed());
  }
  EXPECT_TRUE(adapter.kernel_driver_attached());
}

TEST_F(GsUsbTest, PaddedAdaptersGetAndSendWholePackets) {
  MockAdapter adapter(&peer_,
                      {.features = gs_usb::kHardwareStamps | gs_usb::kPadded});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  EXPECT_EQ(adapter.mode_flags(), gs_usb::kHardwareStamps | gs_usb::kPadded);
  peer_.Plan(MakeCanFrame(0x123, {1, 2}));
  ASSERT_TRUE(*bus.Receive(frame_, kLongNs));
  EXPECT_EQ(frame_.id, 0x123u);
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x201, {7, 0})).ok());
  EXPECT_EQ(adapter.last_sent_size(), 32u);
}

TEST_F(GsUsbTest, OddAdaptersGetOneMoreByte) {
  MockAdapter adapter(&peer_, {.features = gs_usb::kExtraByte});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  // Only stamps and padding are switched on.
  EXPECT_EQ(adapter.mode_flags(), 0u);
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x201, {7, 0})).ok());
  EXPECT_EQ(adapter.last_sent_size(), 21u);
}

TEST_F(GsUsbTest, StampsGoOnWhereTheyWrapAround) {
  // 50 ms before the stamps begin again at 0.
  MockAdapter adapter(&peer_, {.first_stamp_us = 0xFFFFFFFF - 50'000});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  int64_t last_ns = 0;
  for (int i = 0; i < 10; ++i) {
    peer_.Plan(MakeCanFrame(0x123, {1}));
    ASSERT_TRUE(*bus.Receive(frame_, kLongNs));
    EXPECT_GT(frame_.time_ns, last_ns);
    if (i > 0) {
      // Ten milliseconds and what the machine adds.
      EXPECT_GT(frame_.time_ns - last_ns, 9'000'000);
      EXPECT_LT(frame_.time_ns - last_ns, 60'000'000'000);
    }
    last_ns = frame_.time_ns;
    std::this_thread::sleep_for(milliseconds(10));
  }
}

TEST_F(GsUsbTest, OverflowsErrorFramesAndBusOff) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  gs_usb::HostFrame overflow =
      gs_usb::ToHostFrame(MakeCanFrame(0x410, {1}), gs_usb::kNoEcho);
  overflow.flags = gs_usb::kOverflowFlag;
  adapter.SendRaw(gs_usb::Bytes(overflow, true));
  ASSERT_TRUE(*bus.Receive(frame_, kLongNs));
  EXPECT_EQ(bus.counters().overruns, 1u);
  // No frame; a frame of 9 bytes; another channel.
  adapter.SendRaw({1, 2, 3});
  gs_usb::HostFrame nine = overflow;
  nine.size = 9;
  adapter.SendRaw(gs_usb::Bytes(nine, true));
  gs_usb::HostFrame other = overflow;
  other.channel = 1;
  adapter.SendRaw(gs_usb::Bytes(other, true));
  EXPECT_FALSE(*bus.Receive(frame_, 50'000'000));
  EXPECT_EQ(bus.counters().malformed, 2u);
  gs_usb::HostFrame error;
  error.can_id = kCanErrorBit | 0x40;
  error.size = 8;
  adapter.SendRaw(gs_usb::Bytes(error, true));
  const absl::Status status = bus.Receive(frame_, kLongNs).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("bus-off"));
  EXPECT_EQ(bus.counters().bus_offs, 1u);
  // Opening resets and starts the controller.
  ASSERT_TRUE(bus.Open({}).ok());
  peer_.Plan(MakeCanFrame(0x410, {1}));
  EXPECT_TRUE(*bus.Receive(frame_, kLongNs));
}

TEST_F(GsUsbTest, FailedTransfersAreTriedAgain) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  adapter.FailTransfers(20, EPROTO);
  peer_.Plan(MakeCanFrame(0x410, {1}));
  ASSERT_TRUE(*bus.Receive(frame_, kLongNs));
  EXPECT_EQ(bus.counters().malformed, 20u);
  adapter.FailTransfers(100'000, EPROTO);
  EXPECT_EQ(ReasonOf(bus.Receive(frame_, kLongNs).status()), "IO");
}

TEST_F(GsUsbTest, ABusOnWhichNobodyListensTakesTenFrames) {
  MockAdapter adapter(&peer_, {});
  adapter.SetDeaf(true);
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(bus.Send(MakeCanFrame(0x201, {7, 0})).ok()) << i;
  }
  const absl::Status status = bus.Send(MakeCanFrame(0x201, {7, 0}));
  EXPECT_THAT(std::string(status.message()), HasSubstr("nobody on the bus"));
}

TEST_F(GsUsbTest, FiltersPassWhatIsWanted) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  const CanFilter filters[] = {{.id = 0x400, .mask = 0x700}};
  ASSERT_TRUE(bus.Open(filters).ok());
  peer_.Plan(MakeCanFrame(0x310, {1}));
  peer_.Plan(MakeCanFrame(0x410, {2}));
  ASSERT_TRUE(*bus.Receive(frame_, kLongNs));
  EXPECT_EQ(frame_.id, 0x410u);
}

TEST_F(GsUsbTest, AnAdapterThatIsUnpluggedAndPluggedIn) {
  MockAdapter adapter(&peer_, {});
  GsUsb bus({});
  ASSERT_TRUE(bus.Open({}).ok());
  adapter.Unplug();
  const absl::Status gone = bus.Receive(frame_, kLongNs).status();
  EXPECT_THAT(std::string(gone.message()), HasSubstr("unplugged"));
  const absl::Status absent = bus.Open({});
  EXPECT_EQ(ReasonOf(absent), "IO");
  EXPECT_THAT(std::string(absent.message()),
              HasSubstr("there is no gs_usb adapter"));
  adapter.Plug();
  const absl::Status back = bus.Open({});
  ASSERT_TRUE(back.ok()) << back;
  peer_.Plan(MakeCanFrame(0x410, {1}));
  EXPECT_TRUE(*bus.Receive(frame_, kLongNs));
}

TEST_F(GsUsbTest, AdaptersAreFoundBySerialNumber) {
  MockAdapter adapter(&peer_, {.serial = "0042"});
  GsUsb right({.serial = "0042"});
  EXPECT_TRUE(right.Open({}).ok());
  right.Close();
  GsUsb wrong({.serial = "0043"});
  EXPECT_THAT(std::string(wrong.Open({}).message()), HasSubstr("serial"));
  GsUsb channel({.channel = 1});
  EXPECT_EQ(ReasonOf(channel.Open({})), "INVALID_CONFIG");
}

// The whole path over USB: 24 triangles at 50 Hz for two seconds, unplugged and
// plugged in.
TEST_F(GsUsbTest, AForearmOverUsbLosesNothingAndComesBack) {
  const auto boards = *icub::ParseBoards("forearm-v2");
  IcubBoards skin(boards, [](int64_t t, size_t, std::span<double> counts) {
    counts[0] = static_cast<double>(t / 20'000'000 % 100);
  });
  MockAdapter adapter(&skin, {});
  GsUsb bus({});
  icub::IcubSkin protocol(*icub::PortPatch(boards), {.period_ms = 20});
  // The emulated adapter is slow on a loaded machine.
  CanSkinDriver driver(&bus, &protocol, {.give_up_ns = 0});
  BufferedDriver buffered(&driver, {});
  const auto info = buffered.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(buffered.Activate().ok());
  SkinFrame frame;
  int frames = 0;
  uint64_t missing = 0;
  while (frames < 100) {
    const auto result = buffered.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    ++frames;
    missing += frame.missing_before;
  }
  EXPECT_EQ(missing, 0u);
  const DriverStatistics statistics = driver.Statistics();
  RecordProperty("age_ms", std::to_string(statistics.longest_age_ms));
  std::printf(
      "24 triangles at %.2f Hz over USB: jitter %.2f ms, age at most "
      "%.2f ms\n",
      statistics.rate_hz, statistics.jitter_ms, statistics.longest_age_ms);
  adapter.Unplug();
  while (buffered.Statistics().connected) {
    ASSERT_TRUE(buffered.Read(frame).ok());
  }
  EXPECT_THAT(buffered.Statistics().problem, HasSubstr("gs_usb"));
  adapter.Plug();
  for (frames = 0; frames < 20;) {
    const auto result = buffered.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    frames += *result == ReadResult::kFrame;
  }
  EXPECT_TRUE(buffered.Finalise().ok());
  EXPECT_FALSE(adapter.started());
}

}  // namespace
}  // namespace tactus::internal::client
