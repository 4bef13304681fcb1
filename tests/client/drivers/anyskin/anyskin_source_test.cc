// AnySkin as the flags of a program describe it.
#include <cmath>
#include <memory>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/anyskin/anyskin_bytes.h"
#include "tests/client/drivers/serial/talking_skin.h"
#include "tools/common/skin_source.h"

namespace tactus::internal::client {
namespace {

using testing::AnySkinFrame;
using testing::Chips;
using ::testing::HasSubstr;
using testing::Pty;
using testing::TalkingSkin;

SkinSourceOptions Parsed(const std::vector<std::string>& flags) {
  CLI::App app;
  SkinSourceOptions options;
  AddSkinFlags(app, options);
  AddCalibrationFlags(app, options);
  std::vector<std::string> reversed(flags.rbegin(), flags.rend());
  app.parse(reversed);
  return options;
}

// Two chips whose readings alternate around 100 and -200 uT.
std::vector<std::string> Frames() {
  std::vector<std::string> frames;
  for (const float noise : {1.F, -1.F, 2.F, -2.F}) {
    frames.push_back(AnySkinFrame({{25, 100 + noise, -200 - noise, noise},
                                   {26, -100 + noise, 200 - noise, -noise}}));
  }
  return frames;
}

TEST(AnySkinSourceTest, FlagsMakeASkinThatStreams) {
  const Pty pty;
  const TalkingSkin talking(pty, Frames());
  for (const bool tared : {false, true}) {
    std::vector<std::string> flags = {"--driver=anyskin",
                                      "--port=" + pty.path(), "--magnets=2",
                                      "--rate-hz=200", "--scale=0.5"};
    if (tared) flags.emplace_back("--tare=40");
    const SkinSourceOptions options = Parsed(flags);
    ASSERT_TRUE(CheckSkinFlags(options).ok()) << CheckSkinFlags(options);
    EXPECT_EQ(DeviceId(options), "anyskin " + pty.path());
    const auto source = SkinSource::Make(options);
    ASSERT_TRUE(source.ok()) << source.status();
    SkinDriver& driver = (*source)->driver();
    const auto info = driver.Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    EXPECT_EQ(info->layout.name, "anyskin-2");
    EXPECT_EQ(info->layout.columns, 2);
    EXPECT_EQ(info->sample_rate_hz, 200);
    EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_FLOAT32);
    EXPECT_EQ(info->scale, tared ? 1 : 0.5);
    ASSERT_TRUE(driver.Activate().ok());
    SkinFrame frame;
    int negative = 0;
    for (int frames = 0; frames < 20;) {
      const auto result = driver.Read(frame);
      ASSERT_TRUE(result.ok()) << result.status();
      if (*result != ReadResult::kFrame) continue;
      ++frames;
      ASSERT_EQ(frame.f32.size(), 6u);
      for (const float value : frame.f32) {
        EXPECT_LT(std::abs(value), 3);
        negative += value < 0 ? 1 : 0;
      }
    }
    EXPECT_GT(negative, 30);
    EXPECT_TRUE(driver.Finalise().ok());
  }
}

TEST(AnySkinSourceTest, TheLineIsNamed) {
  const absl::Status status = CheckSkinFlags({.driver = "anyskin"});
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()), HasSubstr("--port"));
}

TEST(AnySkinSourceTest, WrongNumbersAreRefused) {
  const SkinSourceOptions options =
      Parsed({"--driver=anyskin", "--port=/dev/null", "--mask=4"});
  const auto source = SkinSource::Make(options);
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_EQ(ReasonOf((*source)->driver().Configure().status()), "IO");
  EXPECT_THROW(Parsed({"--driver=anyskin", "--magnets=65"}),
               CLI::ValidationError);
  EXPECT_FALSE(SkinSource::Make(
                   Parsed({"--driver=anyskin", "--port=/dev/null", "--mask=9"}))
                   .ok());
}

}  // namespace
}  // namespace tactus::internal::client
