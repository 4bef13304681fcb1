// GsUsb with the real libusb, against a session as usbmon records it, which
// umockdev replays: what the driver submits must have the recorded bytes, in
// the recorded order. gs_usb_session.py wrote the session without our driver.
#include <umockdev.h>

#include <cstdlib>

#include "client/drivers/can/can_error.h"
#include "client/drivers/can/gs_usb.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/can/mock_adapter.h"

namespace tactus::internal::client {
namespace {

// A device without a peer, whose ioctls are replayed.
class ReplayedAdapter {
 public:
  explicit ReplayedAdapter(const std::string& pcap)
      : testbed_(umockdev_testbed_new()) {
    AddMockAdapter(testbed_);
    GError* error = nullptr;
    loaded_ = umockdev_testbed_load_pcap(testbed_, kMockAdapterSysPath,
                                         pcap.c_str(), &error) == TRUE;
    if (error != nullptr) {
      problem_ = error->message;
      g_error_free(error);
    }
  }
  ~ReplayedAdapter() { g_object_unref(testbed_); }

  bool loaded() const { return loaded_; }
  const std::string& problem() const { return problem_; }

 private:
  UMockdevTestbed* const testbed_;
  bool loaded_ = false;
  std::string problem_;
};

TEST(GsUsbPcapTest, ARecordedSessionIsReplayed) {
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (preloaded == nullptr ||
      std::string(preloaded).find("umockdev") == std::string::npos) {
    GTEST_SKIP() << "runs under umockdev-wrapper only";
  }
  constexpr int64_t kWaitNs = 2'000'000'000;
  constexpr int kFrames = 40;
  ReplayedAdapter adapter(TACTUS_GS_USB_PCAP);
  ASSERT_TRUE(adapter.loaded()) << adapter.problem();
  GsUsb bus({});
  const absl::Status opened = bus.Open({});
  ASSERT_TRUE(opened.ok()) << opened;
  CanFrame frame;
  int64_t last_ns = 0;
  const auto receive = [&](uint32_t id, std::vector<uint8_t> bytes) {
    const auto received = bus.Receive(frame, kWaitNs);
    ASSERT_TRUE(received.ok()) << received.status();
    ASSERT_TRUE(*received);
    EXPECT_EQ(frame.id, id);
    EXPECT_EQ(std::vector<uint8_t>(frame.bytes().begin(), frame.bytes().end()),
              bytes);
    EXPECT_GE(frame.time_ns, last_ns);
    last_ns = frame.time_ns;
  };
  // More frames than transfers; the stamps wrap around in the middle.
  for (int i = 0; i < kFrames; ++i) {
    receive(0x4D0U + i % 16, {0x40, static_cast<uint8_t>(i), 2, 3, 4, 5, 6, 7});
  }
  receive(0x4C1, {1});
  receive(0x12345, {9, 8});
  EXPECT_TRUE(frame.extended);
  EXPECT_EQ(bus.counters().error_frames, 1u);
  EXPECT_EQ(bus.counters().overruns, 1u);
  EXPECT_EQ(bus.counters().received, kFrames + 2u);
  ASSERT_TRUE(bus.Send(MakeCanFrame(0x20D, {7, 0})).ok());
  for (int i = 0; i < kFrames; ++i) {
    receive(0x4C0, {0xC0, static_cast<uint8_t>(i), 0, 0, 0, 0, 0, 0});
  }
  EXPECT_EQ(bus.counters().sent, 1u);
  EXPECT_EQ(bus.counters().received, 2 * kFrames + 2u);
  EXPECT_EQ(bus.counters().malformed, 0u);
}

// A session that sends other bytes does not go on.
TEST(GsUsbPcapTest, OtherBytesAreNotAnswered) {
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (preloaded == nullptr ||
      std::string(preloaded).find("umockdev") == std::string::npos) {
    GTEST_SKIP() << "runs under umockdev-wrapper only";
  }
  ReplayedAdapter adapter(TACTUS_GS_USB_PCAP);
  ASSERT_TRUE(adapter.loaded()) << adapter.problem();
  GsUsb bus({.bit_rate = 500'000});
  EXPECT_FALSE(bus.Open({}).ok());
}

}  // namespace
}  // namespace tactus::internal::client
