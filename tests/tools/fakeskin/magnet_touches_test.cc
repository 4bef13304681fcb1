// Simulated contacts on the simulated AnySkin skin.
#include "tools/fakeskin/magnet_touches.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "client/drivers/anyskin/anyskin.h"
#include "client/drivers/hardware_driver.h"
#include "core/features/skin_tracker.h"
#include "gtest/gtest.h"
#include "tests/tools/fakeskin/line_clock.h"

namespace tactus::internal::client {
namespace {

using testing::kSecond;
using testing::LineClock;

constexpr size_t kContacts = 12;
constexpr double kNewtonPerUt = 0.001;

// Centre, left, right, up and down, in pitches.
constexpr double kPlaces[][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, 1}, {0, -1}};

SimTouchesOptions Options() {
  return {.seed = 3,
          .contacts = kContacts,
          .begin_ns = 4 * kSecond,
          .pause_ns = 4 * kSecond};
}

// By the forces on the forearm: what they would change all together at one
// place, and where they act.
TEST(MagnetTouchesTest, TheFieldIsThatOfTheForcesWhereTheyAct) {
  SimTouches touches(Options());
  touches.MakeAll();
  const AnySkinBoard::Source source = MagnetSource(touches, kNewtonPerUt);
  const SkinLayout& layout = touches.patch().layout;
  int touched = 0;
  int untouched = 0;
  for (int64_t time_ns = 0; time_ns < *touches.end_ns(); time_ns += kSecond) {
    std::vector<double> newtons(layout.taxels());
    touches.ForcesAt(time_ns, 0, newtons);
    double force = 0;
    double column = 0;
    double row = 0;
    for (int i = 0; i < layout.taxels(); ++i) {
      if (newtons[i] < layout.contact_threshold) continue;
      force += newtons[i];
      column += newtons[i] * (i % layout.columns);
      row += newtons[i] * (i / layout.columns);
    }
    std::vector<double> field(AnySkinBoard::kValues);
    source(time_ns, field);
    if (force == 0) {
      ++untouched;
      EXPECT_EQ(field, std::vector<double>(AnySkinBoard::kValues));
      continue;
    }
    ++touched;
    // In pitches of 7 mm, of which the forearm has 16 / 7.
    const double right = (column / force - 11.5) / 24 * 16 / 7;
    const double up = (row / force - 7.5) / 16 * 16 / 7;
    double nearest = 1e9;
    double nearest_z = 0;
    double least_z = 0;
    for (size_t k = 0; k < AnySkinBoard::kMagnets; ++k) {
      const double distance =
          std::hypot(kPlaces[k][0] - right, kPlaces[k][1] - up);
      EXPECT_LE(field[3 * k + 2], 0) << time_ns;
      EXPECT_GE(field[3 * k + 2], -std::min(3'000.0, force / kNewtonPerUt))
          << time_ns;
      least_z = std::min(least_z, field[3 * k + 2]);
      if (distance >= nearest) continue;
      nearest = distance;
      nearest_z = field[3 * k + 2];
    }
    // A long edge may be a little nearer to another one by its ends.
    EXPECT_LT(nearest_z, 0.75 * least_z) << time_ns;
  }
  EXPECT_GT(touched, 15);
  EXPECT_GT(untouched, 40);
}

// With noise and drift, through line and driver.
TEST(MagnetTouchesTest, EachContactIsOneOfTheDriversStream) {
  SimTouches touches(Options());
  touches.MakeAll();
  AnySkinBoard board({}, MagnetSource(touches, kNewtonPerUt));
  PtyLine line("");
  LineClock clock(&board, &line);
  AnySkin skin(line.path(), {}, &clock);
  HardwareDriver driver(&skin, {}, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(driver.Activate().ok());
  SkinTracker tracker(info->layout, {.max_contacts = 8, .shear = true});
  std::vector<double> loads(kContacts);
  SkinFrame frame;
  while (clock.NowNs() < *touches.end_ns()) {
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    tracker.Step({.taxels = frame.f32});
    const size_t contact = touches.Begun(frame.capture_time_ns);
    for (const auto& track : tracker.contacts()) {
      ASSERT_GT(contact, 0u);
      double& load = loads[contact - 1];
      load = std::max(load, track->features().sample().net_force);
    }
  }
  EXPECT_EQ(driver.Statistics().lost, 0u);
  const auto felt =
      std::ranges::count_if(loads, [](double x) { return x > 0; });
  std::printf("%td of %zu contacts felt, %llu began; loads", felt, kContacts,
              static_cast<unsigned long long>(tracker.contacts_begun()));
  for (const double load : loads) std::printf(" %.0f", load);
  std::printf(" uT\n");
  EXPECT_GE(felt, 10);
  EXPECT_LE(tracker.contacts_begun(), kContacts + 2);
}

}  // namespace
}  // namespace tactus::internal::client
