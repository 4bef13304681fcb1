// Drivers by name, and public drivers as the programs read them.
#include "tactus/driver.h"

#include "client/front/wrapped_driver.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

TEST(MakeDriverTest, TheSimulatorPlaysItsContacts) {
  auto driver = MakeDriver("sim", {{"trials", "2"}, {"seed", "3"}});
  ASSERT_TRUE(driver.ok()) << driver.status();
  const auto skin = (*driver)->Configure();
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_EQ(skin->name, "cody-forearm");
  EXPECT_TRUE(skin->with_poses);
  ASSERT_TRUE((*driver)->Activate().ok());
  int frames = 0;
  int trials = 0;
  for (Frame frame;;) {
    const auto result = (*driver)->Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result == ReadResult::kEndOfData) break;
    if (*result == ReadResult::kEndOfTrial) {
      ++trials;
      continue;
    }
    ++frames;
    EXPECT_EQ(frame.values.size(),
              static_cast<size_t>(skin->rows * skin->columns));
  }
  EXPECT_EQ(trials, 2);
  EXPECT_GT(frames, 200);
  EXPECT_TRUE((*driver)->Finalise().ok());
  // Its states are guarded.
  EXPECT_FALSE((*driver)->Activate().ok());
}

TEST(MakeDriverTest, WrongOptionsAreNamed) {
  struct Case {
    const char* name;
    DriverOptions options;
    const char* what;
  };
  const Case cases[] = {
      {"simulator", {}, "xela-can"},
      {"sim", {{"trails", "2"}}, "trails"},
      {"sim", {{"trials", "two"}}, "trials"},
      {"replay", {}, "option data is absent"},
      {"serial", {}, "option port is absent"},
      {"serial", {{"port", "/dev/x"}, {"format", "morse"}}, "ascii or aa55"},
      {"serial", {{"port", "/dev/x"}, {"rate_hz", "-1"}}, "rate_hz"},
      {"anyskin", {}, "option port is absent"},
      {"anyskin", {{"port", "/dev/x"}, {"magnets", "65"}}, "0 to 64"},
      {"anyskin", {{"port", "/dev/x"}, {"rezero_s", "-1"}}, "rezero_s"},
      {"anyskin", {{"port", "/dev/x"}, {"format", "ascii"}}, "format"},
      {"xela-can", {{"scale", "0"}}, "scale"},
      {"icub-can", {{"period_ms", "256"}}, "0 to 255"},
      {"icub-usb", {{"interface", "can0"}}, "interface"},
      {"./none.so", {}, "none.so"},
  };
  for (const Case& c : cases) {
    const absl::Status status = MakeDriver(c.name, c.options).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << c.name;
    EXPECT_THAT(status.message(), HasSubstr(c.what)) << c.name;
  }
}

TEST(MakeDriverTest, RealSkinsOpenNothingBeforeTheyAreConfigured) {
  for (const char* name : {"xela-can", "icub-can"}) {
    auto driver = MakeDriver(name, {{"interface", "no-such-can"}});
    ASSERT_TRUE(driver.ok()) << driver.status();
    EXPECT_FALSE((*driver)->Configure().ok());
    EXPECT_TRUE((*driver)->Finalise().ok());
  }
}

// Two frames, of which the second does not fit the skin.
class TwoFrames : public Driver {
 public:
  explicit TwoFrames(int* finalised) : finalised_(finalised) {}
  absl::StatusOr<Skin> Configure() override {
    return Skin{.name = "icub-6x10", .scale = 2};
  }
  absl::StatusOr<ReadResult> Read(Frame& frame) override {
    frame.values.assign(read_++ == 0 ? 60 : 59, 3);
    return ReadResult::kFrame;
  }
  absl::Status Finalise() override {
    ++*finalised_;
    return absl::OkStatus();
  }

 private:
  int* const finalised_;
  int read_ = 0;
};

TEST(WrappedDriverTest, APublicDriverHasTheStatesOfAllDrivers) {
  int finalised = 0;
  const auto driver = WrapDriver(std::make_unique<TwoFrames>(&finalised));
  SkinFrame frame;
  EXPECT_FALSE(driver->Read(frame).ok());
  EXPECT_EQ(driver->Configure()->scale, 2);
  ASSERT_TRUE(driver->Activate().ok());
  ASSERT_EQ(*driver->Read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.u16, std::vector<uint16_t>(60, 3));
  EXPECT_THAT(driver->Read(frame).status().message(),
              HasSubstr("60, the skin's values"));
  EXPECT_TRUE(driver->Finalise().ok());
  EXPECT_TRUE(driver->Finalise().ok());
  EXPECT_EQ(finalised, 1);
}

}  // namespace
}  // namespace tactus::internal::client
