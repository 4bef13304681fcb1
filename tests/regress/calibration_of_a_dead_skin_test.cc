// A calibration was made of a skin of which no taxel ever changed, as one
// without power sends: its noise was 0 and its thresholds one step above.
#include "client/drivers/calibration/calibration.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

absl::Status StatusOf(const std::vector<uint8_t>& mask, int changing) {
  SkinInfo info;
  info.layout = *LayoutPreset("vitac-12x32");
  info.layout.mask = mask;
  IdleFrames idle(info, 30);
  for (int t = 0; t < 30; ++t) {
    SkinFrame frame;
    frame.u16.assign(384, 7);
    if (changing >= 0) frame.u16[changing] += t % 2;
    idle.Add(frame);
  }
  return Calibrate(idle, {.device = "bench"}).status();
}

TEST(CalibrationOfADeadSkinTest, IsRefusedWithWhatToCheck) {
  const absl::Status dead = StatusOf({}, -1);
  EXPECT_EQ(ReasonOf(dead), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(dead.message()),
              HasSubstr("no taxel of 384 changed in 30 frames"));
  EXPECT_THAT(std::string(dead.message()), HasSubstr("has power"));
  EXPECT_TRUE(StatusOf({}, 5).ok());
  // A masked taxel does not count.
  std::vector<uint8_t> mask(384, 1);
  mask[5] = 0;
  EXPECT_THAT(std::string(StatusOf(mask, 5).message()),
              HasSubstr("no taxel of 383 changed"));
}

}  // namespace
}  // namespace tactus::internal::client
