// Skipping changes no bit of the features.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

struct Recording {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  std::vector<std::vector<float>> frames;
  std::vector<Pose> poses;
  std::vector<uint64_t> missing;

  FrameView frame(size_t t, bool with_pose) const {
    return {.taxels = frames[t],
            .pose = with_pose ? &poses[t] : nullptr,
            .missing_before = missing[t]};
  }
};

// Touches and losses of touch, many frames the same as the one before, under
// poses that move or rest, with gaps some of which end a contact.
Recording RandomRecording(uint64_t seed) {
  Random random(seed);
  Recording recording;
  std::vector<float> taxels(recording.layout.taxels());
  Pose pose;
  for (int t = 0; t < 400; ++t) {
    if (random.Index(3) == 0) {
      std::ranges::fill(taxels, 0.0F);
      const size_t touched = random.Index(3) == 0 ? 0 : random.Index(40);
      const size_t first = random.Index(taxels.size() - 40);
      for (size_t i = 0; i < touched; ++i) {
        taxels[first + i] = static_cast<float>(random.Uniform(0, 5));
      }
    }
    if (random.Index(2) == 0) {
      pose.position.x() += 0.001;
      pose.orientation = Eigen::Quaterniond(1, random.Uniform(0, 0.1), 0, 0);
      pose.orientation.normalize();
    }
    recording.frames.push_back(taxels);
    recording.poses.push_back(pose);
    recording.missing.push_back(random.Index(10) == 0 ? random.Index(9) : 0);
  }
  return recording;
}

void ExpectEqual(const FrameFeatures& a, const FrameFeatures& b) {
  EXPECT_EQ(a.touched, b.touched);
  EXPECT_EQ(a.max_force, b.max_force);
  EXPECT_EQ(a.net_force, b.net_force);
  EXPECT_EQ(a.area_taxels, b.area_taxels);
  EXPECT_EQ(a.area_m2, b.area_m2);
  EXPECT_EQ(a.motion_m, b.motion_m);
  EXPECT_EQ(a.profile, b.profile);
  EXPECT_EQ(a.region_count, b.region_count);
  EXPECT_EQ(a.centroid.row, b.centroid.row);
  EXPECT_EQ(a.centroid.column, b.centroid.column);
}

// Returns how many frames `options` let the tracker reuse.
int CompareWithNothingSkipped(const ContactTracker::Options& options) {
  int reused = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Recording recording = RandomRecording(seed);
    const bool with_pose = seed % 2 == 0;
    ContactTracker::Options nothing = options;
    nothing.skip_untouched = false;
    nothing.reuse_unchanged = false;
    ContactTracker full(recording.layout, nothing);
    ContactTracker skipping(recording.layout, options);
    for (size_t t = 0; t < recording.frames.size(); ++t) {
      full.Step(recording.frame(t, with_pose));
      skipping.Step(recording.frame(t, with_pose));
      ExpectEqual(full.features(), skipping.features());
      EXPECT_EQ(full.state(), skipping.state());
      EXPECT_EQ(full.onset(), skipping.onset());
      EXPECT_EQ(full.released(), skipping.released());
      EXPECT_FALSE(full.reused());
      reused += skipping.reused();
    }
  }
  return reused;
}

TEST(SkippingTest, UntouchedFramesNeedNoSegmentation) {
  EXPECT_EQ(CompareWithNothingSkipped(
                {.release_after_s = 0.05, .reuse_unchanged = false}),
            0);
}

TEST(SkippingTest, UnchangedFramesKeepTheirFeatures) {
  EXPECT_GT(CompareWithNothingSkipped(
                {.release_after_s = 0.05, .skip_untouched = false}),
            500);
}

TEST(SkippingTest, OnlyTheBytesOfTheFrameBeforeCount) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels());
  taxels[100] = 4;
  tracker.Step({.taxels = taxels});
  EXPECT_FALSE(tracker.reused());
  tracker.Step({.taxels = taxels});
  EXPECT_TRUE(tracker.reused());
  taxels[383] = 1e-40F;
  tracker.Step({.taxels = taxels});
  EXPECT_FALSE(tracker.reused());
  // The first frame of a trial has none before it.
  tracker.Reset();
  tracker.Step({.taxels = taxels});
  EXPECT_FALSE(tracker.reused());
}

// A skin of any size with regions of any size, some of its taxels masked.
SkinLayout DrawLightLayout(Random& random) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.rows = static_cast<int>(3 + random.Index(20));
  layout.columns = static_cast<int>(3 + random.Index(30));
  layout.wrap_columns = random.Index(2) == 0;
  layout.contact_threshold = 0.3;
  layout.onset_threshold = 0.5;
  const bool usual = random.Index(2) == 0;
  const auto size = [&](int most) {
    return usual ? 3 : static_cast<int>(1 + random.Index(std::min(most, 16)));
  };
  layout.light_touch = LightTouch{.window_s = 0.1,
                                  .rows = size(layout.rows),
                                  .columns = size(layout.columns),
                                  .contact_threshold = 0.05,
                                  .onset_threshold = 0.08};
  if (random.Index(3) == 0) {
    layout.mask.assign(layout.taxels(), 1);
    for (uint8_t& taxel : layout.mask) taxel = random.Index(5) != 0;
    layout.mask[0] = 1;
  }
  return layout;
}

// Noise about offsets, and every 0.4 s another load of any size somewhere, some
// of them too light for a single taxel.
class LightFrames {
 public:
  LightFrames(const SkinLayout& layout, uint64_t seed)
      : random_(seed), load_(layout.taxels()), taxels_(layout.taxels()) {}

  const std::vector<float>& Next() {
    if (++frame_ % 40 == 0) {
      std::ranges::fill(load_, 0.0);
      const double force = std::exp(random_.Uniform(-5, 2));
      const size_t first = random_.Index(load_.size());
      const size_t end = std::min(first + random_.Index(40), load_.size());
      for (size_t i = first; i < end; ++i) load_[i] = force;
    }
    for (size_t i = 0; i < taxels_.size(); ++i) {
      taxels_[i] = static_cast<float>(
          std::max(0.0, 0.1 + load_[i] + 0.01 * random_.Gaussian()));
    }
    return taxels_;
  }

 private:
  Random random_;
  int frame_ = 0;
  std::vector<double> load_;
  std::vector<float> taxels_;
};

TEST(SkippingTest, QuietRowsOfLightTouchAreNotSummed) {
  int quiet = 0;
  int felt = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const SkinLayout layout = DrawLightLayout(random);
    const auto contact =
        static_cast<float>(layout.light_touch->contact_threshold);
    LightTouchFilter full(layout, 100);
    LightTouchFilter skipping(layout, 100, /*skip_quiet_rows=*/true);
    LightFrames frames(layout, seed);
    for (int t = 0; t < 400; ++t) {
      const std::vector<float>& taxels = frames.Next();
      full.Step(taxels);
      skipping.Step(taxels);
      EXPECT_EQ(full.quiet_rows(), 0);
      quiet += skipping.quiet_rows();
      EXPECT_EQ(full.peak(), skipping.peak());
      EXPECT_TRUE(std::ranges::equal(full.shape(), skipping.shape())) << t;
      EXPECT_EQ(full.has_shape(), skipping.has_shape());
      if (full.region_peak() >= contact) {
        ++felt;
        EXPECT_EQ(full.region_peak(), skipping.region_peak());
      } else {
        EXPECT_LT(skipping.region_peak(), contact);
      }
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(quiet, 50'000);
  EXPECT_GT(felt, 5'000);
}

TEST(SkippingTest, QuietRowsOfLightTouchChangeNoFeature) {
  int onsets = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    const SkinLayout layout = DrawLightLayout(random);
    ContactTracker full(layout, {.release_after_s = 0.05,
                                 .skip_untouched = false,
                                 .skip_quiet_rows = false});
    ContactTracker skipping(layout, {.release_after_s = 0.05});
    LightFrames frames(layout, seed + 100);
    for (int t = 0; t < 400; ++t) {
      const std::vector<float>& taxels = frames.Next();
      full.Step({.taxels = taxels});
      skipping.Step({.taxels = taxels});
      ExpectEqual(full.features(), skipping.features());
      EXPECT_EQ(full.state(), skipping.state());
      EXPECT_EQ(full.onset(), skipping.onset());
      onsets += full.onset();
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(onsets, 50);
}

}  // namespace
}  // namespace tactus::internal
