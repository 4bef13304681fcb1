// AnySkin over a pseudo-terminal.
#include "client/drivers/anyskin/anyskin.h"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <thread>

#include "client/drivers/hardware_driver.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/features/skin_tracker.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/anyskin/anyskin_bytes.h"
#include "tests/client/drivers/serial/talking_skin.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

using testing::AnySkinFrame;
using testing::Chip;
using testing::Chips;
using ::testing::HasSubstr;
using testing::Pty;
using testing::TalkingSkin;

// What a board at rest reads: other fields for each chip, and noise that
// follows from the number of the frame.
Chips AtRest(int frame) {
  Random random(static_cast<uint64_t>(frame) + 1);
  Chips chips(5);
  for (size_t i = 0; i < chips.size(); ++i) {
    const auto offset = static_cast<float>(i);
    const auto noise = [&] {
      return 2 * static_cast<float>(random.Gaussian());
    };
    chips[i] = {25, 300 - 100 * offset + noise(), -50 * offset + noise(),
                -1'000 + 10 * offset + noise()};
  }
  return chips;
}

// A board on a thread, which sends frame after frame as fast as they are read.
class BoardOnLine {
 public:
  explicit BoardOnLine(std::function<std::string(int)> bytes_of)
      : sender_([this, bytes_of = std::move(bytes_of)] {
          for (int i = 0; !stop_; ++i) pty.Write(bytes_of(i));
          sent_ = true;
        }) {}
  ~BoardOnLine() {
    stop_ = true;
    // Its last frame may wait for a reader.
    const int line = open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    char bytes[4096];
    while (!sent_) {
      if (read(line, bytes, sizeof bytes) <= 0) std::this_thread::yield();
    }
    sender_.join();
    close(line);
  }

  const Pty pty;

 private:
  std::atomic<bool> stop_ = false;
  std::atomic<bool> sent_ = false;
  std::thread sender_;
};

SkinFrame NextFrame(HardwareDriver& driver) {
  SkinFrame frame;
  while (true) {
    const auto result = driver.Read(frame);
    EXPECT_TRUE(result.ok()) << result.status();
    if (!result.ok() || *result == ReadResult::kFrame) return frame;
  }
}

// The mean of `count` frames.
std::vector<double> MeanOf(HardwareDriver& driver, int count) {
  std::vector<double> mean(27);
  for (int i = 0; i < count; ++i) {
    const SkinFrame frame = NextFrame(driver);
    EXPECT_EQ(frame.f32.size(), mean.size());
    for (size_t k = 0; k < mean.size(); ++k) mean[k] += frame.f32[k] / count;
  }
  return mean;
}

double LoadOf(const std::vector<double>& values, size_t taxel) {
  return std::hypot(values[3 * taxel], values[3 * taxel + 1],
                    values[3 * taxel + 2]);
}

TEST(AnySkinTest, ValuesAreAboveTheUntouchedSkinOnACross) {
  // From frame 1000 on each chip reads another field.
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    for (size_t k = 0; k < 5 && i >= 1'000; ++k) {
      chips[k].z -= 200 * static_cast<float>(k + 1);
    }
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 400, .rezero_s = 0});
  HardwareDriver driver(&skin, {});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_FLOAT32);
  EXPECT_EQ(info->layout, AnySkinLayout(5));
  EXPECT_EQ(info->sample_rate_hz, 400);
  ASSERT_TRUE(driver.Activate().ok());
  const std::vector<double> rest = MeanOf(driver, 200);
  for (size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(rest[i], 0, 1) << i;
  MeanOf(driver, 800);
  const std::vector<double> pressed = MeanOf(driver, 200);
  // Centre, left, right, up and down.
  const size_t places[] = {4, 3, 5, 7, 1};
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(pressed[3 * places[k] + 2], -200 * (k + 1.0), 1) << k;
    EXPECT_NEAR(pressed[3 * places[k]], 0, 1) << k;
  }
  for (const size_t corner : {0, 2, 6, 8}) {
    EXPECT_EQ(info->layout.mask[corner], 0);
    EXPECT_EQ(LoadOf(pressed, corner), 0);
  }
  EXPECT_EQ(driver.Statistics().incomplete, 0u);
}

// The public viewer draws the x and y of a chip turned by these angles, with y
// downwards. What all chips draw to the right and upwards is one shear.
TEST(AnySkinTest, TurnedChipsHaveTheAxesOfTheSkin) {
  const double angles[] = {-std::numbers::pi / 2, -std::numbers::pi / 2,
                           std::numbers::pi, std::numbers::pi / 2, 0};
  const double right = 300;
  const double down = -400;
  BoardOnLine line([&](int i) {
    Chips chips = AtRest(i);
    for (size_t k = 0; k < 5 && i >= 1'000; ++k) {
      // The inverse of the viewer's turn.
      chips[k].x += static_cast<float>(std::cos(angles[k]) * right +
                                       std::sin(angles[k]) * down);
      chips[k].y += static_cast<float>(-std::sin(angles[k]) * right +
                                       std::cos(angles[k]) * down);
    }
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 400, .rezero_s = 0});
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  MeanOf(driver, 1'000);
  const std::vector<double> pulled = MeanOf(driver, 200);
  for (const size_t taxel : {4, 3, 5, 7, 1}) {
    EXPECT_NEAR(pulled[3 * taxel], 300, 1) << taxel;
    EXPECT_NEAR(pulled[3 * taxel + 1], 400, 1) << taxel;
  }
}

// Negative values are loads and shear like others.
TEST(AnySkinTest, ATouchThatLowersAllAxesIsAContactWithShear) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    if (i >= 1'000) {
      // The right chip, whose x points to the left on the skin.
      chips[2].x += 120;
      chips[2].y -= 50;
      chips[2].z -= 400;
    }
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 400});
  HardwareDriver driver(&skin, {});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(driver.Activate().ok());
  SkinTracker tracker(info->layout, {.max_contacts = 8, .shear = true});
  for (int i = 0; i < 1'200; ++i) {
    const SkinFrame frame = NextFrame(driver);
    tracker.Step({.taxels = frame.f32});
  }
  EXPECT_EQ(tracker.contacts_begun(), 1u);
  ASSERT_EQ(tracker.contacts().size(), 1u);
  const ContactSample sample = tracker.contacts()[0]->features().sample();
  EXPECT_NEAR(sample.net_force, std::hypot(120, 50, 400), 10);
  EXPECT_NEAR(sample.shear.first, -120, 10);
  EXPECT_NEAR(sample.shear.second, -50, 10);
}

TEST(AnySkinTest, GarbageBeforeAndLostBytesAreCounted) {
  BoardOnLine line([](int i) {
    std::string bytes = AnySkinFrame(AtRest(i));
    if (i == 0) bytes = "MLX90393 ready\r\n\r\n" + bytes;
    // One byte in the middle of each hundredth frame.
    if (i % 100 == 99) bytes.erase(40, 1);
    return bytes;
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 400});
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  const uint64_t before = driver.Statistics().incomplete;
  MeanOf(driver, 990);
  EXPECT_NEAR(static_cast<double>(driver.Statistics().incomplete - before), 10,
              1);
}

constexpr int kDriftEnd = 20'000;
constexpr int kTouchEnd = 40'000;

// The rest moves by 400 uT in steps that are slow; then a touch of 150 uT lasts
// for forty times the time of the drift.
TEST(AnySkinTest, TheRestIsFollowedAndATouchIsNot) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    const auto drift =
        400 * static_cast<float>(std::min(i, int{kDriftEnd})) / kDriftEnd;
    for (Chip& chip : chips) chip.x += drift;
    if (i >= kDriftEnd && i < kTouchEnd) chips[0].z += 150;
    return AnySkinFrame(chips);
  });
  // 500 frames.
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 100, .rezero_s = 5});
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  const std::vector<double> begin = skin.Untouched();
  ASSERT_TRUE(driver.Activate().ok());
  // No more than the time of the drift is behind, 10 uT; without it, 380.
  MeanOf(driver, 19'000);
  EXPECT_LT(LoadOf(MeanOf(driver, 500), 4), 20);
  MeanOf(driver, 5'000);
  EXPECT_NEAR(MeanOf(driver, 500)[3 * 4 + 2], 150, 3);
  MeanOf(driver, 14'000);
  EXPECT_NEAR(MeanOf(driver, 500)[3 * 4 + 2], 150, 3);
  MeanOf(driver, 3'000);
  EXPECT_LT(LoadOf(MeanOf(driver, 500), 4), 10);
  // The centre's x is the skin's y.
  EXPECT_NEAR(skin.Untouched()[3 * 4 + 1] - begin[3 * 4 + 1], 400, 10);
}

TEST(AnySkinTest, ATouchAtTheStartIsRefused) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    if (i >= 50) chips[3].z += 60;
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 100});
  HardwareDriver driver(&skin, {});
  const absl::Status status = driver.Configure().status();
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr(line.pty.path() + ": the skin is touched: taxel 7 "
                                          "changed along z by"));
}

// Chips measure more slowly than the board sends.
TEST(AnySkinTest, RepeatedReadingsAreNoTouch) {
  BoardOnLine line([](int i) { return AnySkinFrame(AtRest(i / 5)); });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 400});
  HardwareDriver driver(&skin, {});
  const auto info = driver.Configure();
  EXPECT_TRUE(info.ok()) << info.status();
}

TEST(AnySkinTest, AChipThatNeverChangesIsNamed) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    chips[1] = {451.8F, -0.2F, -0.2F, -0.3F};
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 100});
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_THAT(driver.Statistics().remarks,
              HasSubstr("the same numbers all the time: 1; check"));
}

TEST(AnySkinTest, NumbersThatAreNoneAreRefusedAndTold) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    if (i % 10 == 5) chips[4].x = std::numeric_limits<float>::quiet_NaN();
    if (i % 10 == 7) chips[4].x = 3e38F;
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.sample_rate_hz = 100});
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  for (int i = 0; i < 500; ++i) {
    for (const float value : NextFrame(driver).f32) {
      ASSERT_TRUE(std::isfinite(value) && std::abs(value) < 1'000) << value;
    }
  }
  EXPECT_GE(skin.counters().out_of_range, 100u);
  EXPECT_THAT(driver.Statistics().refused, HasSubstr("magnetometer 4 sent"));
}

// The line is gone while the skin is at rest and comes back while it is
// touched.
TEST(AnySkinTest, ASkinThatIsPluggedInAgainKeepsItsRest) {
  const ScratchDir dir;
  const std::string path = dir / "ttyACM0";
  AnySkin skin(path, {.sample_rate_hz = 100});
  HardwareDriver driver(&skin, {});
  {
    Pty pty;
    std::filesystem::create_symlink(pty.path(), path);
    const TalkingSkin talking(pty,
                              {AnySkinFrame(AtRest(1)), AnySkinFrame(AtRest(2)),
                               AnySkinFrame(AtRest(3))});
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    MeanOf(driver, 50);
  }
  std::filesystem::remove(path);
  SkinFrame frame;
  while (driver.Statistics().connected) {
    ASSERT_TRUE(driver.Read(frame).ok());
  }
  // Several tries fail meanwhile, after which it is set up anew.
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(driver.Read(frame).ok());
  Pty again;
  Chips touched = AtRest(1);
  touched[0].z += 500;
  const TalkingSkin talking(again, {AnySkinFrame(touched)});
  std::filesystem::create_symlink(again.path(), path);
  while (*driver.Read(frame) != ReadResult::kFrame) continue;
  EXPECT_NEAR(frame.f32[3 * 4 + 2], 500, 10);
  EXPECT_GT(frame.missing_before, 0u);
  EXPECT_EQ(driver.Statistics().reconnects, 1u);
  EXPECT_TRUE(driver.Statistics().connected);
}

TEST(AnySkinTest, SilenceOtherBytesAndOtherBoardsAreToldApart) {
  const auto message = [](const std::string& path, int magnets) {
    AnySkin skin(path, {.magnets = magnets, .first_frame_ns = 300'000'000});
    HardwareDriver driver(&skin, {});
    const absl::Status status = driver.Configure().status();
    EXPECT_EQ(ReasonOf(status), "IO");
    return std::string(status.message());
  };
  const Pty silent;
  EXPECT_THAT(message(silent.path(), 5), HasSubstr("the skin sends nothing"));
  Chips chips = AtRest(1);
  chips.insert(chips.end(), chips.begin(), chips.begin() + 5);
  const BoardOnLine ten([&](int) { return AnySkinFrame(chips); });
  EXPECT_THAT(message(ten.pty.path(), 5),
              HasSubstr("without a whole frame of 5 magnetometers, but frames "
                        "of 10: give that number"));
  const BoardOnLine text([](int) { return "25.1\t1.00\t2.00\t3.00\r\n"; });
  EXPECT_THAT(message(text.pty.path(), 5), HasSubstr("82 bytes are a frame"));
}

TEST(AnySkinTest, ABoardOfAnyNumberIsARow) {
  BoardOnLine line([](int i) {
    Chips chips = AtRest(i);
    chips.resize(2);
    return AnySkinFrame(chips);
  });
  AnySkin skin(line.pty.path(), {.magnets = 2, .sample_rate_hz = 100});
  HardwareDriver driver(&skin, {});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout.rows, 1);
  EXPECT_EQ(info->layout.columns, 2);
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(NextFrame(driver).f32.size(), 6u);
}

TEST(AnySkinTest, OptionsThatCannotBeRightAreNamed) {
  struct Case {
    const char* what;
    AnySkinOptions options;
  };
  SkinLayout one_axis = AnySkinLayout(5);
  one_axis.axes = 1;
  SkinLayout large = AnySkinLayout(6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {
      {"magnetometers is 0; it must be 1 to 64", {.magnets = 0}},
      {"magnetometers is 65", {.magnets = 65}},
      {"axes of the layout of a magnetic skin", {.layout = one_axis}},
      {"taxels of the layout is 6; it must be 5, one for each",
       {.layout = large}},
      {"sample_rate_hz is nan", {.sample_rate_hz = nan}},
      {"sample_rate_hz is 0", {.sample_rate_hz = 0}},
      {"scale is -1", {.scale = -1}},
      {"rezero_s is -1", {.rezero_s = -1}},
      {"rezero_s is 0.5; it must be 0, or 1", {.rezero_s = 0.5}},
      {"rezero_s is nan", {.rezero_s = nan}},
      {"baud is 12345", {.baud = 12'345}},
  };
  const Pty pty;
  for (const Case& c : cases) {
    AnySkin skin(pty.path(), c.options);
    const absl::Status status = skin.Open();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << c.what;
    EXPECT_THAT(std::string(status.message()), HasSubstr(c.what));
  }
  AnySkin absent("/dev/no-such-line", {});
  EXPECT_EQ(ReasonOf(absent.Open()), "IO");
}

}  // namespace
}  // namespace tactus::internal::client
