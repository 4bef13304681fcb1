// A USB adapter whose limits are close to 2^32 got a bit timing outside of its
// limits: the smallest second segment, the largest one and the step of the
// prescaler overflowed 32 bits while the timing was searched.
#include <cstdint>
#include <vector>

#include "client/drivers/can/gs_usb_protocol.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::gs_usb {
namespace {

constexpr uint32_t kLargest = 0xFFFFFFFF;

// Any limits, with which 48 MHz make 1 Mbit/s in several ways.
BitConstants Constants() {
  return {.features = 0,
          .clock_hz = 48'000'000,
          .tseg1_min = 1,
          .tseg1_max = 256,
          .tseg2_min = 1,
          .tseg2_max = 128,
          .sjw_max = 4,
          .brp_min = 1,
          .brp_max = 1024,
          .brp_increment = 1};
}

bool IsWithin(const BitTiming& timing, const BitConstants& limits) {
  const uint64_t tseg1 = uint64_t{timing.prop_seg} + timing.phase_seg1;
  const uint32_t step = limits.brp_increment == 0 ? 1 : limits.brp_increment;
  return tseg1 >= limits.tseg1_min && tseg1 <= limits.tseg1_max &&
         timing.phase_seg2 >= limits.tseg2_min &&
         timing.phase_seg2 <= limits.tseg2_max &&
         timing.brp >= limits.brp_min && timing.brp <= limits.brp_max &&
         (timing.brp - limits.brp_min) % step == 0;
}

TEST(BitTimingThatOverflowsTest, AHugeSecondSegmentIsRefused) {
  for (const uint32_t smallest : {kLargest, kLargest - 1, kLargest - 2}) {
    for (const uint32_t rate : {500'000u, 1'000'000u}) {
      BitConstants constants = Constants();
      constants.tseg2_min = smallest;
      constants.tseg2_max = kLargest;
      const auto timing = ChooseBitTiming(constants, rate);
      EXPECT_EQ(ReasonOf(timing.status()), "INVALID_CONFIG")
          << smallest << " " << rate;
    }
  }
}

TEST(BitTimingThatOverflowsTest, AHugeStepOfThePrescalerLeavesTheFirstOne) {
  BitConstants constants = Constants();
  // From 2 the step would lead to 1, whose 48 quanta fit better than 24.
  constants.brp_min = 2;
  constants.tseg2_min = 6;
  constants.tseg2_max = 6;
  constants.tseg1_min = 41;
  constants.brp_increment = kLargest;
  EXPECT_EQ(ReasonOf(ChooseBitTiming(constants, 1'000'000).status()),
            "INVALID_CONFIG");
  constants.tseg1_min = 1;
  const auto timing = ChooseBitTiming(constants, 1'000'000);
  ASSERT_TRUE(timing.ok());
  EXPECT_EQ(*timing, (BitTiming{1, 16, 6, 1, 2}));
}

// All combinations of numbers at both ends: each timing that comes out is one
// that the adapter allows.
TEST(BitTimingThatOverflowsTest, NoTimingIsOutsideOfTheLimits) {
  const std::vector<uint32_t> ends = {0,
                                      1,
                                      2,
                                      4,
                                      40,
                                      1024,
                                      0x7FFFFFFF,
                                      0x80000000,
                                      kLargest - 4096,
                                      kLargest - 2,
                                      kLargest - 1,
                                      kLargest};
  const std::vector<uint32_t BitConstants::*> fields = {
      &BitConstants::tseg1_min,    &BitConstants::tseg1_max,
      &BitConstants::tseg2_min,    &BitConstants::tseg2_max,
      &BitConstants::brp_min,      &BitConstants::brp_max,
      &BitConstants::brp_increment};
  int found = 0;
  for (const auto first : fields) {
    for (const auto second : fields) {
      for (const uint32_t a : ends) {
        for (const uint32_t b : ends) {
          BitConstants constants = Constants();
          constants.*first = a;
          constants.*second = b;
          for (const uint32_t rate : {100'000u, 500'000u, 1'000'000u}) {
            const auto timing = ChooseBitTiming(constants, rate);
            if (!timing.ok()) continue;
            ++found;
            ASSERT_TRUE(IsWithin(*timing, constants))
                << a << " " << b << " " << rate << " " << timing->prop_seg
                << " " << timing->phase_seg1 << " " << timing->phase_seg2 << " "
                << timing->brp;
          }
        }
      }
    }
  }
  EXPECT_GT(found, 1'000);
}

}  // namespace
}  // namespace tactus::internal::client::gs_usb
