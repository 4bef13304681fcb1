// The simulated AnySkin board, by its bytes and by the driver.
#include "tools/fakeskin/anyskin_board.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <vector>

#include "client/drivers/anyskin/anyskin.h"
#include "client/drivers/hardware_driver.h"
#include "core/base/errors.h"
#include "core/features/skin_tracker.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/anyskin/anyskin_bytes.h"
#include "tests/support/scratch_dir.h"
#include "tests/tools/fakeskin/line_clock.h"

namespace tactus::internal::client {
namespace {

using testing::AnySkinFrame;
using testing::Chip;
using testing::Chips;
using ::testing::HasSubstr;
using testing::kSecond;
using testing::LineClock;

constexpr size_t kMagnets = AnySkinBoard::kMagnets;

void Untouched(int64_t /*time_ns*/, std::span<double> /*field_ut*/) {}

// From the fourth second on each magnetometer feels something else: 300 uT to
// the right and 400 up for each step of the order, and 200 inwards.
constexpr double kRight[kMagnets] = {300, 600, 900, 1'200, 1'500};
constexpr double kUp[kMagnets] = {400, 800, 1'200, 1'600, 2'000};
constexpr double kOut[kMagnets] = {-200, -400, -600, -800, -1'000};

void TouchAll(int64_t time_ns, std::span<double> field_ut) {
  if (time_ns < 4 * kSecond) return;
  for (size_t i = 0; i < kMagnets; ++i) {
    field_ut[3 * i] = kRight[i];
    field_ut[3 * i + 1] = kUp[i];
    field_ut[3 * i + 2] = kOut[i];
  }
}

// The numbers of a frame, as the public viewer reads them.
Chips Read(const std::string& bytes) {
  Chips chips(kMagnets);
  EXPECT_EQ(bytes.size(), 82u);
  if (bytes.size() != 82) return chips;
  static_assert(sizeof(Chip) == 16);
  std::memcpy(chips.data(), bytes.data(), 80);
  EXPECT_EQ(AnySkinFrame(chips), bytes);
  return chips;
}

// Mean numbers of all frames in a time of the board.
Chips MeanOf(AnySkinBoard& board, int64_t begin_ns, int64_t end_ns) {
  Chips sum(kMagnets, {0, 0, 0, 0});
  float frames = 0;
  std::string bytes;
  while (board.NextNs() < end_ns) {
    const int64_t time_ns = board.NextNs();
    EXPECT_FALSE(board.Emit(time_ns - 1, bytes));
    EXPECT_TRUE(board.Emit(time_ns, bytes));
    if (time_ns < begin_ns) continue;
    const Chips chips = Read(bytes);
    for (size_t i = 0; i < kMagnets; ++i) {
      sum[i].t += chips[i].t;
      sum[i].x += chips[i].x;
      sum[i].y += chips[i].y;
      sum[i].z += chips[i].z;
    }
    ++frames;
  }
  for (Chip& chip : sum) {
    chip = {chip.t / frames, chip.x / frames, chip.y / frames, chip.z / frames};
  }
  return sum;
}

// The public viewer turns the x and y of the chips by these angles, and draws
// y downwards.
TEST(AnySkinBoardTest, ItsBytesAreThoseOfTurnedChips) {
  const double angles[] = {-std::numbers::pi / 2, -std::numbers::pi / 2,
                           std::numbers::pi, std::numbers::pi / 2, 0};
  AnySkinBoard board({.rate_hz = 200, .drift_ut = 0}, TouchAll);
  const Chips rest = MeanOf(board, 0, 4 * kSecond);
  const Chips touched = MeanOf(board, 4 * kSecond, 8 * kSecond);
  EXPECT_EQ(board.frames(), 1'600u);
  for (size_t i = 0; i < kMagnets; ++i) {
    EXPECT_NEAR(rest[i].t, 25, 0.1) << i;
    EXPECT_NEAR(rest[i].z, -1'000, 310) << i;
    const double x = touched[i].x - rest[i].x;
    const double y = touched[i].y - rest[i].y;
    const double right = std::cos(angles[i]) * x - std::sin(angles[i]) * y;
    const double down = std::sin(angles[i]) * x + std::cos(angles[i]) * y;
    // A mean of 800 numbers has a thirtieth of the noise.
    EXPECT_NEAR(right, kRight[i], 0.5) << i;
    EXPECT_NEAR(down, -kUp[i], 0.5) << i;
    EXPECT_NEAR(touched[i].z - rest[i].z, kOut[i], 0.5) << i;
  }
}

TEST(AnySkinBoardTest, TheSeedFixesTheBytes) {
  std::string first;
  std::string second;
  for (const uint64_t seed : {1, 2}) {
    AnySkinBoard board({.seed = seed}, Untouched);
    AnySkinBoard same({.seed = seed}, Untouched);
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(board.Emit(board.NextNs(), first));
      ASSERT_TRUE(same.Emit(same.NextNs(), second));
      ASSERT_EQ(first, second);
    }
    AnySkinBoard other({.seed = seed + 1}, Untouched);
    ASSERT_TRUE(other.Emit(other.NextNs(), second));
    EXPECT_NE(first, second);
  }
}

// The board, its line and the driver that reads it.
struct Bench {
  Bench(const AnySkinBoardOptions& board_options, AnySkinBoard::Source source,
        AnySkinOptions options, const std::string& link = "")
      : board(board_options, std::move(source)),
        line(link),
        clock(&board, &line),
        skin(line.path(), options, &clock),
        driver(&skin, {}, &clock) {}

  // Frames that come in the next `duration_ns`.
  std::vector<SkinFrame> Frames(int64_t duration_ns) {
    const int64_t end_ns = clock.NowNs() + duration_ns;
    std::vector<SkinFrame> frames;
    SkinFrame frame;
    while (clock.NowNs() < end_ns) {
      const auto result = driver.Read(frame);
      EXPECT_TRUE(result.ok()) << result.status();
      if (!result.ok()) break;
      if (*result == ReadResult::kFrame) frames.push_back(frame);
    }
    return frames;
  }

  AnySkinBoard board;
  PtyLine line;
  LineClock clock;
  AnySkin skin;
  HardwareDriver driver;
};

std::vector<double> MeanOf(const std::vector<SkinFrame>& frames) {
  std::vector<double> mean(27);
  for (const SkinFrame& frame : frames) {
    for (size_t i = 0; i < mean.size(); ++i) {
      mean[i] += frame.f32[i] / static_cast<double>(frames.size());
    }
  }
  return mean;
}

TEST(AnySkinBoardTest, TheDriverReadsEachMagnetometerWhereItIs) {
  Bench bench({.drift_ut = 0}, TouchAll, {.rezero_s = 0});
  const auto info = bench.driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(bench.driver.Activate().ok());
  EXPECT_EQ(bench.driver.Statistics().remarks,
            "the line has no setting for low latency");
  const std::vector<double> rest = MeanOf(bench.Frames(2 * kSecond));
  for (size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(rest[i], 0, 1) << i;
  bench.Frames(2 * kSecond);
  const auto frames = bench.Frames(2 * kSecond);
  const std::vector<double> touched = MeanOf(frames);
  // Centre, left, right, up and down, in rows of three from below.
  const size_t places[] = {4, 3, 5, 7, 1};
  for (size_t k = 0; k < kMagnets; ++k) {
    EXPECT_NEAR(touched[3 * places[k]], kRight[k], 1) << k;
    EXPECT_NEAR(touched[3 * places[k] + 1], kUp[k], 1) << k;
    EXPECT_NEAR(touched[3 * places[k] + 2], kOut[k], 1) << k;
  }
  EXPECT_NEAR(static_cast<double>(frames.size()), 200, 2);
  const DriverStatistics statistics = bench.driver.Statistics();
  EXPECT_EQ(statistics.lost, 0u);
  EXPECT_EQ(statistics.incomplete, 0u);
  EXPECT_NEAR(statistics.rate_hz, 100, 0.1);
}

TEST(AnySkinBoardTest, EachLostByteIsALostFrame) {
  for (const double rate_hz : {100, 400}) {
    Bench bench({.rate_hz = rate_hz, .drift_ut = 0}, Untouched,
                {.sample_rate_hz = rate_hz});
    ASSERT_TRUE(bench.driver.Configure().ok());
    ASSERT_TRUE(bench.driver.Activate().ok());
    bench.Frames(kSecond);
    EXPECT_EQ(bench.driver.Statistics().lost, 0u);
    bench.board.fault.lose_byte_every = 10;
    uint64_t missing = 0;
    for (const SkinFrame& frame : bench.Frames(10 * kSecond)) {
      missing += frame.missing_before;
      for (const float value : frame.f32) ASSERT_LT(std::abs(value), 15);
    }
    bench.board.fault.lose_byte_every = 0;
    for (const SkinFrame& frame : bench.Frames(kSecond)) {
      missing += frame.missing_before;
    }
    const DriverStatistics statistics = bench.driver.Statistics();
    EXPECT_NEAR(static_cast<double>(bench.board.damaged()), rate_hz, 1);
    EXPECT_EQ(statistics.incomplete, bench.board.damaged());
    EXPECT_EQ(statistics.lost, bench.board.damaged());
    EXPECT_EQ(missing, bench.board.damaged());
  }
}

// A press of 250 uT on the centre in 2 of 8 s, from the fourth on.
bool IsPressed(int64_t time_ns) {
  return time_ns / kSecond >= 4 && (time_ns / kSecond - 4) % 8 < 2;
}

void PressCentre(int64_t time_ns, std::span<double> field_ut) {
  if (IsPressed(time_ns)) field_ut[2] = -250;
}

// The drift of half an hour, and the time over which it is followed, in a
// quarter of their time.
TEST(AnySkinBoardTest, TheDriftMakesContactsUnlessTheRestIsFollowed) {
  for (const double rezero_s : {15., 0.}) {
    Bench bench({.drift_time_s = 150}, PressCentre, {.rezero_s = rezero_s});
    const auto info = bench.driver.Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    ASSERT_TRUE(bench.driver.Activate().ok());
    SkinTracker tracker(info->layout, {.max_contacts = 8, .shear = true});
    int wrong = 0;
    int frames = 0;
    for (const SkinFrame& frame : bench.Frames(400 * kSecond)) {
      tracker.Step({.taxels = frame.f32});
      ++frames;
      // The onset is a frame late, and the release half a second.
      const bool pressed = IsPressed(frame.capture_time_ns) ||
                           IsPressed(frame.capture_time_ns - kSecond);
      wrong += !tracker.contacts().empty() && !pressed;
    }
    std::printf("re-zero %g s: %d of %d frames in a contact without a press\n",
                rezero_s, wrong, frames);
    if (rezero_s > 0) {
      EXPECT_EQ(wrong, 0);
      EXPECT_EQ(tracker.contacts_begun(), 50u);
    } else {
      EXPECT_GT(wrong, frames / 4);
    }
  }
}

TEST(AnySkinBoardTest, ALineThatIsPulledOutComesBack) {
  const ScratchDir folder;
  Bench bench({.drift_ut = 0}, Untouched, {}, folder / "skin");
  EXPECT_EQ(bench.skin.name(), folder / "skin");
  ASSERT_TRUE(bench.driver.Configure().ok());
  ASSERT_TRUE(bench.driver.Activate().ok());
  EXPECT_GT(bench.Frames(kSecond).size(), 90u);
  bench.clock.Unplug();
  EXPECT_LT(bench.Frames(3 * kSecond).size(), 10u);
  EXPECT_FALSE(bench.driver.Statistics().connected);
  bench.clock.Plug();
  const auto frames = bench.Frames(10 * kSecond);
  ASSERT_GT(frames.size(), 500u);
  EXPECT_GT(frames.front().missing_before, 290u);
  const std::vector<double> rest = MeanOf(frames);
  for (size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(rest[i], 0, 1) << i;
  EXPECT_EQ(bench.driver.Statistics().reconnects, 1u);
}

TEST(AnySkinBoardTest, ADeadBoardIsSilentAndAStillMagnetometerIsNamed) {
  Bench bench({.drift_ut = 0}, Untouched, {.first_frame_ns = kSecond / 5});
  bench.board.fault.dead = true;
  const absl::Status status = bench.driver.Configure().status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("the skin sends nothing"));
  EXPECT_EQ(bench.board.frames(), 0u);
  bench.board.fault = {.still_magnet = 3};
  ASSERT_TRUE(bench.driver.Configure().ok());
  EXPECT_THAT(bench.driver.Statistics().remarks,
              HasSubstr("the same numbers all the time: 3; check"));
}

}  // namespace
}  // namespace tactus::internal::client
