#include "client/drivers/can/gs_usb_protocol.h"

#include "client/drivers/can/can_error.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::gs_usb {
namespace {

using ::testing::ElementsAre;

// The constants of candleLight's bxCAN devices, with this clock.
BitConstants Constants(uint32_t clock_hz) {
  return {.features = 0,
          .clock_hz = clock_hz,
          .tseg1_min = 1,
          .tseg1_max = 16,
          .tseg2_min = 1,
          .tseg2_max = 8,
          .sjw_max = 4,
          .brp_min = 1,
          .brp_max = 1024,
          .brp_increment = 1};
}

TEST(GsUsbTimingTest, OneMegabitAtTheUsualClocks) {
  const auto timing = [](uint32_t clock_hz) {
    return *ChooseBitTiming(Constants(clock_hz), 1'000'000);
  };
  EXPECT_EQ(timing(48'000'000), (BitTiming{1, 12, 2, 1, 3}));
  EXPECT_EQ(timing(80'000'000), (BitTiming{1, 12, 2, 1, 5}));
  EXPECT_EQ(timing(40'000'000), (BitTiming{1, 5, 1, 1, 5}));
  // 42 MHz has no exact sample point: 12 of 14 quanta.
  EXPECT_EQ(timing(42'000'000), (BitTiming{1, 10, 2, 1, 3}));
}

TEST(GsUsbTimingTest, AnyTimingIsWithinTheDevicesLimits) {
  for (const uint32_t clock_hz : {24'000'000u, 36'000'000u, 40'000'000u,
                                  48'000'000u, 80'000'000u, 160'000'000u}) {
    for (const uint32_t rate :
         {10'000u, 125'000u, 250'000u, 500'000u, 800'000u, 1'000'000u}) {
      const BitConstants constants = Constants(clock_hz);
      const auto timing = ChooseBitTiming(constants, rate);
      if (!timing.ok()) {
        ADD_FAILURE() << clock_hz << " " << rate;
        continue;
      }
      const uint32_t tseg1 = timing->prop_seg + timing->phase_seg1;
      EXPECT_EQ(clock_hz,
                rate * timing->brp * (1 + tseg1 + timing->phase_seg2));
      EXPECT_LE(tseg1, constants.tseg1_max);
      EXPECT_LE(timing->phase_seg2, constants.tseg2_max);
      EXPECT_GE(timing->phase_seg1, 1u);
    }
  }
}

TEST(GsUsbTimingTest, ARateThatTheClockCannotMakeIsRefused) {
  EXPECT_EQ(ReasonOf(ChooseBitTiming(Constants(48'000'000), 999'999).status()),
            "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(ChooseBitTiming(Constants(48'000'000), 0).status()),
            "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(ChooseBitTiming({}, 1'000'000).status()),
            "INVALID_CONFIG");
}

TEST(GsUsbFrameTest, BytesAreThoseOfTheProtocol) {
  const HostFrame frame{.echo_id = 3,
                        .can_id = 0x201,
                        .size = 2,
                        .channel = 0,
                        .flags = 0,
                        .data = {0x07, 0x00},
                        .stamp_us = 0x01020304};
  EXPECT_THAT(Bytes(frame, true),
              ElementsAre(3, 0, 0, 0, 0x01, 0x02, 0, 0, 2, 0, 0, 0, 7, 0, 0, 0,
                          0, 0, 0, 0, 4, 3, 2, 1));
  EXPECT_EQ(Bytes(frame, false).size(), 20u);
  EXPECT_THAT(
      Bytes(BitTiming{1, 12, 2, 1, 3}),
      ElementsAre(1, 0, 0, 0, 12, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0));
}

TEST(GsUsbFrameTest, FramesComeBackPaddedOrNot) {
  Random random(3);
  for (int i = 0; i < 1'000; ++i) {
    CanFrame can;
    can.extended = random.Index(2) == 1;
    can.remote = random.Index(4) == 0;
    can.id = static_cast<uint32_t>(random.Index(can.extended ? 1 << 29 : 2048));
    can.size = static_cast<uint8_t>(random.Index(9));
    for (uint8_t& byte : can.data) {
      byte = static_cast<uint8_t>(random.Index(256));
    }
    HostFrame host = ToHostFrame(can, kNoEcho);
    host.stamp_us = static_cast<uint32_t>(random.Index(1ULL << 32));
    auto bytes = Bytes(host, true);
    bytes.resize(24 + random.Index(41), 0);
    const auto back = ReadHostFrame(bytes, true);
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(back->stamp_us, host.stamp_us);
    EXPECT_TRUE(ToCanFrame(*back).SameAs(can));
  }
}

TEST(GsUsbFrameTest, ShortAndImpossibleFramesAreNone) {
  const auto bytes = Bytes(HostFrame{}, true);
  for (size_t size = 0; size < 24; ++size) {
    const std::span<const uint8_t> part(bytes.data(), size);
    EXPECT_EQ(ReadHostFrame(part, false).has_value(), size >= 20) << size;
    EXPECT_FALSE(ReadHostFrame(part, true).has_value());
  }
  auto nine = bytes;
  nine[8] = 9;
  EXPECT_FALSE(ReadHostFrame(nine, true).has_value());
  EXPECT_FALSE(ReadBitConstants(nine).has_value());
}

TEST(GsUsbFrameTest, BitConstantsComeBack) {
  const BitConstants constants = Constants(48'000'000);
  const auto back = ReadBitConstants(Bytes(constants));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->clock_hz, 48'000'000u);
  EXPECT_EQ(back->tseg2_max, 8u);
  EXPECT_EQ(back->brp_increment, 1u);
}

TEST(CanErrorTest, BusOffAndOverflowAreFound) {
  const uint8_t overflow[8] = {0, 1};
  EXPECT_TRUE(ReadCanError(kCanErrorBit | 0x40, {}).bus_off);
  EXPECT_FALSE(ReadCanError(kCanErrorBit | 0x08, overflow).bus_off);
  EXPECT_TRUE(ReadCanError(kCanErrorBit | 0x04, overflow).overflow);
  EXPECT_FALSE(ReadCanError(kCanErrorBit | 0x04, {overflow, 1}).overflow);
}

// Stamps every 10 ms from a device whose clock is 100 ppm fast, that reach the
// host 0.2 to 5 ms later, over three wrap-arounds.
TEST(StampClockTest, TimesFollowTheDeviceThroughWrapsDriftAndDelays) {
  StampClock clock;
  Random random(9);
  int64_t last_ns = 0;
  double worst_ms = 0;
  for (int64_t i = 0; i < 1'400'000; ++i) {
    const int64_t true_ns = i * 10'000'000 + 7'000'000'000;
    const auto stamp = static_cast<uint32_t>(
        (4'294'000'000LL + true_ns / 1'000 + true_ns / 10'000'000) &
        0xFFFFFFFF);
    const auto delay_ns = static_cast<int64_t>(random.Uniform(2e5, 5e6));
    const int64_t host_ns = clock.HostTimeNs(stamp, true_ns + delay_ns);
    ASSERT_GE(host_ns, last_ns);
    ASSERT_LE(host_ns, true_ns + delay_ns);
    last_ns = host_ns;
    if (i < 1'000) continue;
    worst_ms = std::max(worst_ms,
                        std::abs(static_cast<double>(host_ns - true_ns)) / 1e6);
  }
  // The shortest delay is 0.2 ms; the memory of it fades.
  EXPECT_LT(worst_ms, 1.0);
}

TEST(StampClockTest, ALongSilenceStartsAnew) {
  StampClock clock;
  EXPECT_EQ(clock.HostTimeNs(5, 1'000'000), 1'000'000);
  // Two hours later; the stamp has wrapped around more than once.
  const int64_t later_ns = 7'200'000'000'000;
  EXPECT_EQ(clock.HostTimeNs(9, later_ns), later_ns);
}

}  // namespace
}  // namespace tactus::internal::client::gs_usb
