#include "tools/fakeskin/gs_usb_firmware.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using gs_usb::Request;

constexpr int64_t kBeginNs = 5'000'000'000;

uint8_t Number(Request request) { return static_cast<uint8_t>(request); }

TEST(GsUsbFirmwareTest, StartsOnlyWithATimingAndFlagsThatItHas) {
  GsUsbFirmware firmware({}, kBeginNs);
  const auto start = gs_usb::Bytes({gs_usb::kModeStart, 0});
  EXPECT_FALSE(firmware.Write(Number(Request::kMode), start));
  ASSERT_TRUE(firmware.Write(Number(Request::kBitTiming),
                             gs_usb::Bytes(gs_usb::BitTiming{1, 12, 2, 1, 3})));
  EXPECT_FALSE(
      firmware.Write(Number(Request::kMode),
                     gs_usb::Bytes({gs_usb::kModeStart, gs_usb::kPadded})));
  EXPECT_FALSE(firmware.started());
  EXPECT_TRUE(firmware.Write(Number(Request::kMode), start));
  EXPECT_TRUE(firmware.started());
  EXPECT_TRUE(firmware.Write(Number(Request::kMode),
                             gs_usb::Bytes({gs_usb::kModeReset, 0})));
  EXPECT_FALSE(firmware.started());
  EXPECT_FALSE(firmware.Write(Number(Request::kMode), {}));
  EXPECT_FALSE(firmware.Write(200, start));
  EXPECT_FALSE(firmware.Read(200, kBeginNs));
}

TEST(GsUsbFirmwareTest, FramesAndEchoesHaveStampsOfOneClock) {
  GsUsbFirmware firmware({.first_stamp_us = 0xFFFFFFFF}, kBeginNs);
  ASSERT_TRUE(firmware.Write(Number(Request::kBitTiming),
                             gs_usb::Bytes(gs_usb::BitTiming{1, 12, 2, 1, 3})));
  const gs_usb::HostFrame host =
      gs_usb::ToHostFrame(MakeCanFrame(0x201, {7, 0}), 3);
  const auto bytes = gs_usb::Bytes(host, false);
  EXPECT_FALSE(firmware.TakeSent(bytes, kBeginNs));
  ASSERT_TRUE(firmware.Write(
      Number(Request::kMode),
      gs_usb::Bytes({gs_usb::kModeStart, gs_usb::kHardwareStamps})));
  const auto sent = firmware.TakeSent(bytes, kBeginNs + 8'000);
  ASSERT_TRUE(sent);
  EXPECT_TRUE(sent->frame.SameAs(MakeCanFrame(0x201, {7, 0})));
  const auto echo = gs_usb::ReadHostFrame(sent->echo, true);
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->echo_id, 3u);
  EXPECT_EQ(echo->flags, 0);
  // Wrapped around.
  EXPECT_EQ(echo->stamp_us, 7u);
  CanFrame scan = MakeCanFrame(0x4D5, {0x40, 1, 2, 3, 4, 5, 6, 7});
  scan.time_ns = kBeginNs + 9'000;
  const auto received = gs_usb::ReadHostFrame(firmware.FromBus(scan), true);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->echo_id, gs_usb::kNoEcho);
  EXPECT_EQ(received->stamp_us, 8u);
  EXPECT_TRUE(gs_usb::ToCanFrame(*received).SameAs(scan));
  EXPECT_EQ(firmware.Read(Number(Request::kTimestamp), kBeginNs + 10'000),
            gs_usb::Bytes({9}));
  EXPECT_FALSE(firmware.TakeSent({bytes.data(), 19}, kBeginNs));
}

}  // namespace
}  // namespace tactus::internal::client
