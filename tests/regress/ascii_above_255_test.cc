// A skin of 10 bits on a serial line lost every frame in which a taxel read
// more than 255, which is every frame in which it was pressed. Nothing said so:
// the message was "without a whole frame of 8 x 8, but frames of 8 x 8".
#include <string>

#include "client/drivers/hardware_driver.h"
#include "client/drivers/serial/serial_skin.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/serial/talking_skin.h"

namespace tactus::internal::client {
namespace {

using testing::AsBytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Values;

SerialSkinOptions SmallSkin() {
  SerialSkinOptions options{.sample_rate_hz = 100};
  options.layout = *LayoutPreset("vitac-12x32");
  options.layout.rows = 2;
  options.layout.columns = 2;
  options.first_frame_ns = 300'000'000;
  return options;
}

TEST(AsciiAbove255Test, TheFramesOfAPressAreReadAsThoseBefore) {
  SerialFrames frames(SerialFormat::kAscii, 2, 2);
  frames.Add(AsBytes("\n0 1\n2 3\n\n0 700\n255 256\n\n0 65535\n0 0\n\n"), 5);
  Values values;
  int64_t time_ns = 0;
  ASSERT_TRUE(frames.Next(values, time_ns));
  ASSERT_TRUE(frames.Next(values, time_ns));
  EXPECT_THAT(values, ElementsAre(0, 700, 255, 256));
  ASSERT_TRUE(frames.Next(values, time_ns));
  EXPECT_THAT(values, ElementsAre(0, 65535, 0, 0));
  EXPECT_EQ(frames.counters().spoiled, 0u);
  EXPECT_EQ(frames.OutOfRange(), "");
}

struct Unfit {
  const char* bytes;
  const char* text;
};

class UnfitValuesTest : public ::testing::TestWithParam<Unfit> {};

TEST_P(UnfitValuesTest, AreNamed) {
  const testing::Pty pty;
  const testing::TalkingSkin talking(pty, {GetParam().bytes});
  SerialSkin skin(pty.path(), SmallSkin());
  HardwareDriver driver(&skin, {});
  const std::string message(driver.Configure().status().message());
  EXPECT_THAT(message, HasSubstr(GetParam().text));
  EXPECT_THAT(message, HasSubstr("takes whole numbers from 0 to 65535"));
  EXPECT_THAT(message, Not(HasSubstr("but frames")));
}

INSTANTIATE_TEST_SUITE_P(
    All, UnfitValuesTest,
    ::testing::Values(Unfit{"1 2\n3 70000\n\n", "values up to 70000 came"},
                      Unfit{"1 -3\n3 4\n\n", "values down to -3 came"},
                      Unfit{"1 2\n3 12.5\n\n", "the value 12.5 came"}));

// Frames before and after are whole, so the connection is never broken.
TEST(AsciiAbove255Test, FramesThatAreLostOnlyWhilePressedAreTold) {
  const testing::Pty pty;
  const testing::TalkingSkin talking(
      pty, {"1 2\n3 4\n\n", "1 2\n3 4\n\n", "1 2\n3 70000\n\n"});
  SerialSkin skin(pty.path(), SmallSkin());
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  while (skin.counters().out_of_range < 3) ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_THAT(driver.Statistics().refused,
              HasSubstr("values up to 70000 came"));
}

TEST(AsciiAbove255Test, ASkinOfAnotherFormatIsNamed) {
  const testing::Pty pty;
  const testing::TalkingSkin talking(pty, {"1 2\n3 4\n\n"});
  SerialSkinOptions options = SmallSkin();
  options.format = SerialFormat::kAa55;
  SerialSkin skin(pty.path(), options);
  HardwareDriver driver(&skin, {});
  EXPECT_THAT(std::string(driver.Configure().status().message()),
              HasSubstr("in ascii: give --format=ascii"));
}

}  // namespace
}  // namespace tactus::internal::client
