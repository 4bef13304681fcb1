#include "core/light_touch/light_touch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

constexpr double kLightRate = 100;
constexpr int kFirstFrames = 30;

// Contact at 1 and onset at 2 for a taxel; a tenth for regions of 3 x 2 over
// 0.1 s.
SkinLayout LightLayout(int rows, int columns, bool wrap) {
  SkinLayout layout = testing::FlatLayout(rows, columns);
  layout.wrap_columns = wrap;
  layout.onset_threshold = 2;
  layout.light_touch = LightTouch{.window_s = 0.1,
                                  .rows = 3,
                                  .columns = 2,
                                  .contact_threshold = 0.1,
                                  .onset_threshold = 0.2};
  return layout;
}

// The filter by its description, in double precision and one taxel at a time.
class PlainFilter {
 public:
  explicit PlainFilter(const SkinLayout& layout)
      : layout_(layout),
        smooth_(layout.taxels()),
        background_(smooth_),
        touched_(smooth_),
        regions_(smooth_),
        values_(smooth_),
        shape_(smooth_) {
    for (size_t i = 0; i < smooth_.size(); ++i) {
      members_.push_back(RegionOf(static_cast<int>(i)));
    }
  }

  void Step(const std::vector<float>& taxels) {
    ++frames_;
    const double plain = 1.0 / frames_;
    const double fast = std::max(plain, 1 - std::exp(-1 / (kLightRate * 0.1)));
    const double slow = std::max(plain, 1 / kLightRate);
    const LightTouch& light = *layout_.light_touch;
    const bool ready = frames_ > kFirstFrames;
    std::vector<double> difference(taxels.size());
    for (size_t i = 0; i < taxels.size(); ++i) {
      smooth_[i] += fast * (taxels[i] - smooth_[i]);
      if (!ready) {
        background_[i] += slow * (taxels[i] - background_[i]);
        continue;
      }
      const double reach = layout_.contact_threshold;
      smooth_[i] = std::clamp(smooth_[i], taxels[i] - reach, taxels[i] + reach);
      const bool valid = layout_.mask.empty() || layout_.mask[i] != 0;
      difference[i] = valid ? smooth_[i] - background_[i] : 0;
      values_[i] = valid ? std::max(0.0, taxels[i] - background_[i]) : 0;
    }
    if (!ready) return;
    for (size_t i = 0; i < taxels.size(); ++i) {
      double sum = 0;
      for (const int j : members_[i]) sum += difference[j];
      regions_[i] = sum / (light.rows * light.columns);
    }
    std::vector<char> felt(taxels.size());
    std::vector<char> rests(taxels.size());
    for (size_t i = 0; i < taxels.size(); ++i) {
      const bool stays = regions_[i] >= light.contact_threshold;
      touched_[i] = regions_[i] >= light.onset_threshold ||
                    values_[i] >= layout_.contact_threshold ||
                    (touched_[i] > 0 && stays);
      for (const int j : members_[i]) {
        felt[j] |= stays || touched_[i] > 0;
        rests[j] |= touched_[i] > 0;
      }
    }
    for (size_t i = 0; i < taxels.size(); ++i) {
      shape_[i] = felt[i] ? difference[i] : 0;
      if (!rests[i]) background_[i] += slow * (taxels[i] - background_[i]);
    }
  }

  const std::vector<double>& regions() const { return regions_; }
  const std::vector<double>& values() const { return values_; }
  const std::vector<double>& shape() const { return shape_; }

 private:
  std::vector<int> RegionOf(int taxel) const {
    const LightTouch& light = *layout_.light_touch;
    const int row = taxel / layout_.columns;
    const int column = taxel % layout_.columns;
    std::vector<int> region;
    for (int r = row - (light.rows - 1) / 2; r <= row + light.rows / 2; ++r) {
      for (int c = column - (light.columns - 1) / 2;
           c <= column + light.columns / 2; ++c) {
        if (r < 0 || r >= layout_.rows) continue;
        const bool inside = c >= 0 && c < layout_.columns;
        if (!layout_.wrap_columns && !inside) continue;
        region.push_back(r * layout_.columns +
                         (c + layout_.columns) % layout_.columns);
      }
    }
    return region;
  }

  SkinLayout layout_;
  std::vector<std::vector<int>> members_;  // of each taxel's region
  int frames_ = 0;
  std::vector<double> smooth_, background_, touched_, regions_, values_, shape_;
};

void ExpectAllNear(std::span<const float> ours,
                   const std::vector<double>& plain) {
  ASSERT_EQ(ours.size(), plain.size());
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(ours[i], plain[i], 1e-5) << i;
  }
}

// Light and strong touches, offsets, masked taxels, all kinds of shapes.
TEST(LightTouchFilterTest, AgreesWithItsDescription) {
  Random random(1);
  for (int run = 0; run < 80; ++run) {
    const bool wrap = random.Index(2) == 0;
    const int rows = static_cast<int>(3 + random.Index(14));
    const int columns = static_cast<int>(3 + random.Index(22));
    SkinLayout layout = LightLayout(rows, columns, wrap);
    layout.light_touch->rows = static_cast<int>(1 + random.Index(rows));
    layout.light_touch->columns = static_cast<int>(1 + random.Index(columns));
    layout.light_touch->rows = std::min(layout.light_touch->rows, 16);
    layout.light_touch->columns = std::min(layout.light_touch->columns, 16);
    // The usual region, which is summed in another way.
    if (run % 2 == 0)
      layout.light_touch->rows = layout.light_touch->columns = 3;
    if (run % 3 == 0) {
      layout.mask.assign(layout.taxels(), 1);
      for (uint8_t& taxel : layout.mask) taxel = random.Index(4) != 0;
      layout.mask[0] = 1;
    }
    LightTouchFilter filter(layout, kLightRate);
    PlainFilter plain(layout);
    std::vector<float> taxels(layout.taxels());
    std::vector<double> load(layout.taxels());
    for (int t = 0; t < 300; ++t) {
      if (t % 50 == 20) {
        std::ranges::fill(load, 0.0);
        const double force = std::exp(random.Uniform(-3, 3));
        const size_t first = random.Index(load.size());
        for (size_t i = first; i < std::min(first + 4, load.size()); ++i) {
          load[i] = force;
        }
      }
      for (size_t i = 0; i < taxels.size(); ++i) {
        taxels[i] = static_cast<float>(std::max(
            0.0, (i % 7 == 0 ? 3 : 0.1) + load[i] + 0.05 * random.Gaussian()));
      }
      filter.Step(taxels);
      plain.Step(taxels);
      ASSERT_NO_FATAL_FAILURE(ExpectAllNear(filter.regions(), plain.regions()));
      ExpectAllNear(filter.values(), plain.values());
      EXPECT_EQ(filter.peak(), *std::ranges::max_element(filter.values()));
      EXPECT_EQ(filter.region_peak(),
                std::max(0.0F, *std::ranges::max_element(filter.regions())));
      // A mean next to a threshold may be rounded to either side.
      const auto near_threshold = [&](double region) {
        return std::abs(region - 0.1) < 1e-5 || std::abs(region - 0.2) < 1e-5;
      };
      if (std::ranges::any_of(plain.regions(), near_threshold)) break;
      ExpectAllNear(filter.shape(), plain.shape());
      if (::testing::Test::HasFailure()) return;
    }
  }
}

// 40 taxels on a flat skin, all of them offset by 5.
class LightScript {
 public:
  explicit LightScript(const SkinLayout& layout, double rate = kLightRate)
      : layout_(layout),
        load_(layout.taxels()),
        tracker_(layout, {.sample_rate_hz = rate, .release_after_s = 0.2}) {}

  // Adds `load` to 3 x 2 taxels from row 1, column 2 on.
  void SetLoad(double load) {
    for (int i = 0; i < 6; ++i) {
      load_[(1 + i / 2) * layout_.columns + 2 + i % 2] = load;
    }
  }

  const FrameFeatures& Frame(double offset = 5, double noise = 0.02) {
    std::vector<float> taxels(load_.size());
    for (size_t i = 0; i < taxels.size(); ++i) {
      taxels[i] =
          static_cast<float>(offset + load_[i] + noise * random_.Gaussian());
    }
    return tracker_.Step({taxels});
  }
  void Frames(int count) {
    for (int i = 0; i < count; ++i) Frame();
  }

  ContactTracker& tracker() { return tracker_; }
  bool in_contact() const {
    return tracker_.state() == ContactState::kInContact;
  }

 private:
  SkinLayout layout_;
  std::vector<double> load_;
  ContactTracker tracker_;
  Random random_{3};
};

TEST(LightTouchTest, ARegionFeelsWhatNoTaxelDoes) {
  LightScript script(LightLayout(5, 8, false));
  script.Frames(200);
  EXPECT_FALSE(script.in_contact());
  EXPECT_FALSE(script.tracker().features().touched);
  // 0.4 on each taxel, at 0.1 s time constant: half is reached after 0.07 s.
  script.SetLoad(0.4);
  int frames = 0;
  for (; !script.in_contact() && frames < 50; ++frames) script.Frame();
  EXPECT_GE(frames, 5);
  EXPECT_LE(frames, 9);
  script.Frames(30);
  const FrameFeatures& features = script.Frame();
  EXPECT_EQ(features.region_count, 1);
  EXPECT_EQ(features.area_taxels, 6);
  EXPECT_NEAR(features.net_force, 2.4, 0.25);
  EXPECT_NEAR(features.max_force, 0.4, 0.1);
  EXPECT_EQ(features.centroid.row, 2);
  EXPECT_EQ(features.centroid.column, 2.5);
  EXPECT_GT(features.profile[1], 0);
  script.SetLoad(0);
  script.Frames(50);
  EXPECT_FALSE(script.in_contact());
}

// The same frames on the skin without light touch: all taxels are touched by
// their offset.
TEST(LightTouchTest, OffsetsAreNoContact) {
  SkinLayout layout = LightLayout(5, 8, false);
  LightScript with(layout);
  layout.light_touch.reset();
  LightScript without(layout);
  with.Frames(100);
  without.Frames(100);
  EXPECT_FALSE(with.in_contact());
  EXPECT_TRUE(without.in_contact());
}

TEST(LightTouchTest, StrongContactsBeginAndEndAtOnce) {
  LightScript script(LightLayout(5, 8, false));
  script.Frames(100);
  script.SetLoad(30);
  const FrameFeatures& first = script.Frame();
  EXPECT_TRUE(script.tracker().onset());
  EXPECT_EQ(first.area_taxels, 6);
  EXPECT_NEAR(first.net_force, 180, 0.5);
  script.Frames(300);
  // The force of the very frame, without any lag.
  script.SetLoad(20);
  EXPECT_NEAR(script.Frame().net_force, 120, 0.5);
  EXPECT_EQ(script.tracker().features().area_taxels, 6);
  script.SetLoad(0);
  script.Frames(50);
  EXPECT_FALSE(script.in_contact());
}

// A reading between the thresholds for a taxel and for its mean.
TEST(LightTouchTest, ATaxelAtItsThresholdIsTouchedAtOnce) {
  SkinLayout layout = LightLayout(5, 8, false);
  layout.onset_threshold = 1.2;
  layout.light_touch->contact_threshold = 1;
  layout.light_touch->onset_threshold = 1;
  LightScript script(layout);
  script.Frames(100);
  script.SetLoad(1.3);
  EXPECT_EQ(script.Frame().area_taxels, 6);
  EXPECT_TRUE(script.tracker().onset());
}

TEST(LightTouchTest, NothingIsFeltInTheFirstThirdOfASecond) {
  LightScript script(LightLayout(5, 8, false));
  for (int i = 0; i < kFirstFrames; ++i) {
    if (i == 10) script.SetLoad(50);
    EXPECT_FALSE(script.Frame().touched);
  }
  // Another trial begins anew.
  script.SetLoad(0);
  script.tracker().Reset();
  script.Frames(40);
  script.SetLoad(50);
  script.Frame();
  EXPECT_TRUE(script.in_contact());
  script.tracker().Reset();
  EXPECT_FALSE(script.Frame().touched);
  script.Frames(100);
  EXPECT_FALSE(script.in_contact());
}

// A robot that rests against an object for a minute still feels it.
TEST(LightTouchTest, AStrongContactIsNoBackground) {
  LightScript script(LightLayout(5, 8, false));
  script.Frames(100);
  script.SetLoad(3);
  script.Frames(6000);
  EXPECT_TRUE(script.in_contact());
  EXPECT_NEAR(script.Frame().net_force, 18, 0.3);
}

// An offset that rises to the level of a light touch ends after 10 s and little
// more.
TEST(LightTouchTest, ADriftIsReleased) {
  LightScript script(LightLayout(5, 8, false));
  script.Frames(100);
  script.SetLoad(0.5);
  script.Frames(900);
  EXPECT_TRUE(script.in_contact());
  EXPECT_NEAR(script.Frame().net_force, 3, 0.3);
  script.Frames(400);
  EXPECT_FALSE(script.in_contact());
  EXPECT_FALSE(script.tracker().features().touched);
  script.SetLoad(0.9);
  script.Frames(40);
  EXPECT_TRUE(script.in_contact());
}

// A background that rose by 1 in a minute is followed.
TEST(LightTouchTest, SlowDriftIsBackground) {
  LightScript script(LightLayout(5, 8, false));
  for (int i = 0; i < 6000; ++i) script.Frame(5 + i / 6000.0);
  EXPECT_FALSE(script.in_contact());
}

TEST(LightTouchTest, ReusedFramesDoNotStopTheMeans) {
  SkinLayout layout = LightLayout(5, 8, false);
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels());
  for (int i = 0; i < 40; ++i) tracker.Step({taxels});
  taxels[11] = 5;
  for (int i = 0; i < 100; ++i) tracker.Step({taxels});
  EXPECT_FALSE(tracker.reused());
  EXPECT_EQ(tracker.features().max_force, 5);
}

TEST(LightTouchTest, StepAllocatesNothing) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.light_touch = LightTouch{0.1, 3, 3, 0.001, 0.002};
  ContactTracker tracker(layout, {});
  Random random(5);
  std::vector<float> taxels(layout.taxels());
  int onsets = 0;
  const testing::AllocationCounter allocations;
  for (int i = 0; i < 2'000; ++i) {
    const double density = i / 100 % 2 == 0 ? 0 : random.Uniform();
    for (float& taxel : taxels) {
      taxel = random.Uniform() < density ? 1.0F : 0.0F;
    }
    tracker.Step({taxels});
    onsets += tracker.onset();
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_GT(onsets, 5);
}

// Means of a skin that reads 0 again do not creep into denormal numbers.
TEST(LightTouchTest, MeansDoNotBecomeDenormal) {
  const SkinLayout layout = LightLayout(5, 8, false);
  LightTouchFilter filter(layout, kLightRate);
  std::vector<float> taxels(layout.taxels(), 0.05F);
  for (int i = 0; i < 100; ++i) filter.Step(taxels);
  std::ranges::fill(taxels, 0.0F);
  for (int i = 0; i < 20'000; ++i) {
    filter.Step(taxels);
    for (const float value : filter.regions()) {
      EXPECT_TRUE(value == 0 || std::isnormal(value)) << value;
    }
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace tactus::internal
