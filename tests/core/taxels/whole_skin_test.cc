#include "core/taxels/whole_skin.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr int kSkinTaxels = 40;

std::vector<TaxelLoad> LoadsAt(uint32_t first,
                               const std::vector<double>& loads) {
  std::vector<TaxelLoad> touched;
  for (size_t i = 0; i < loads.size(); ++i) {
    touched.push_back({static_cast<uint32_t>(first + i),
                       static_cast<float>(std::sqrt(loads[i]))});
  }
  return touched;
}

TEST(WholeSkinTrackerTest, ASteadyPressHasTheNumbersOfItsPattern) {
  WholeSkinTracker tracker(kSkinTaxels, 100);
  for (int n = 0; n < 100; ++n) tracker.Step(LoadsAt(5, {1, 4, 3}));
  const auto& numbers = tracker.numbers();
  EXPECT_NEAR(numbers.root_force, std::sqrt(8), 1e-6);
  EXPECT_NEAR(numbers.root_taxels, std::sqrt(3), 1e-9);
  EXPECT_NEAR(numbers.peak_share, 0.5, 1e-6);
  EXPECT_NEAR(numbers.log_spread, std::log(64.0 / 26), 1e-6);
  EXPECT_NEAR(numbers.force_rate, 0, 1e-9);
  // Nothing lies elsewhere: the floors.
  EXPECT_NEAR(numbers.change_short, std::log(0.02), 1e-5);
  EXPECT_NEAR(numbers.change_since_onset, std::log(0.02), 1e-5);
  EXPECT_NEAR(numbers.log_travel, std::log(0.05), 1e-5);
}

TEST(WholeSkinTrackerTest, AHarderPressKeepsItsPattern) {
  WholeSkinTracker tracker(kSkinTaxels, 100);
  for (int n = 1; n <= 100; ++n) {
    tracker.Step(LoadsAt(5, {0.1 * n, 0.4 * n, 0.3 * n}));
  }
  EXPECT_GT(tracker.numbers().force_rate, 0.1);
  EXPECT_NEAR(tracker.numbers().change_long, std::log(0.02), 1e-4);
  EXPECT_NEAR(tracker.numbers().log_travel, std::log(0.05), 1e-4);
}

TEST(WholeSkinTrackerTest, AnObjectThatSlidesChangesThePattern) {
  WholeSkinTracker tracker(kSkinTaxels, 100);
  for (int n = 0; n < 100; ++n) tracker.Step(LoadsAt(n / 4, {1, 4, 3}));
  const auto& numbers = tracker.numbers();
  // All of the load lies elsewhere than at onset.
  EXPECT_NEAR(numbers.change_since_onset, std::log(1.02), 1e-3);
  EXPECT_GT(numbers.change_long, std::log(0.7));
  EXPECT_GT(numbers.log_travel, std::log(5));
  tracker.Reset();
  tracker.Step(LoadsAt(5, {1, 4, 3}));
  EXPECT_NEAR(tracker.numbers().change_since_onset, std::log(0.02), 1e-9);
}

TEST(WholeSkinTrackerTest, PlacesAndTheirNumbersDoNotMatter) {
  WholeSkinTracker here(kSkinTaxels, 100);
  WholeSkinTracker there(kSkinTaxels, 100);
  for (int n = 0; n < 60; ++n) {
    const double load = 1 + 0.02 * n;
    here.Step(LoadsAt(n < 30 ? 2 : 3, {load, 2, 1}));
    std::vector<TaxelLoad> elsewhere;
    // The same loads at taxels 39 - i.
    for (const TaxelLoad& each : LoadsAt(n < 30 ? 2 : 3, {load, 2, 1})) {
      elsewhere.insert(elsewhere.begin(), {39 - each.taxel, each.root});
    }
    there.Step(elsewhere);
  }
  EXPECT_NEAR(here.numbers().root_force, there.numbers().root_force, 1e-12);
  EXPECT_NEAR(here.numbers().log_spread, there.numbers().log_spread, 1e-12);
  EXPECT_NEAR(here.numbers().change_long, there.numbers().change_long, 1e-12);
  EXPECT_NEAR(here.numbers().log_travel, there.numbers().log_travel, 1e-12);
}

TEST(WholeSkinTrackerTest, FramesWithoutLoadAreFinite) {
  WholeSkinTracker tracker(kSkinTaxels, 100);
  tracker.Step({});
  tracker.Step(LoadsAt(0, {0}));
  tracker.Step(LoadsAt(0, {1e30, 1e30}));
  EXPECT_TRUE(std::isfinite(tracker.numbers().root_force));
  EXPECT_TRUE(std::isfinite(tracker.numbers().log_spread));
  EXPECT_TRUE(std::isfinite(tracker.numbers().log_travel));
}

}  // namespace
}  // namespace tactus::internal
