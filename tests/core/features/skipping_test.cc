// Skipping changes no bit of the features.
#include <vector>

#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "core/features/cues.h"
#include "gtest/gtest.h"

namespace tactus {
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

TEST(SkippingTest, AGroupOfCuesNeedsNoOther) {
  for (const CueGroups group : {0U, kLevelCues, kSpringCues, kShortWindowCues,
                                kLongWindowCues, kRoughnessCues}) {
    Random random(3);
    CueTracker all(100);
    CueTracker some(100, group);
    for (int t = 1; t <= 200; ++t) {
      ContactSample sample = {{random.Uniform(0, 5), random.Uniform(0, 1e-2),
                               random.Uniform(0, 0.02)},
                              random.Uniform(0, 9)};
      sample.profile[3] = random.Uniform();
      all.Step(sample, t);
      some.Step(sample, t);
      for (int i = 0; i < kCueCount; ++i) {
        const Cue cue = static_cast<Cue>(i);
        const bool has = !IsDerived(cue) || GroupOf(cue) == group;
        EXPECT_EQ(some.value(cue), has ? all.value(cue) : 0) << CueName(cue);
      }
    }
  }
}

TEST(SkippingTest, EveryDerivedCueIsOfOneGroup) {
  CueGroups seen = 0;
  for (int i = 0; i < kCueCount; ++i) {
    const Cue cue = static_cast<Cue>(i);
    const CueGroups group = GroupOf(cue);
    EXPECT_EQ(group != 0, IsDerived(cue) || IsTaxelCue(cue)) << CueName(cue);
    EXPECT_EQ(group & (group - 1), 0u) << CueName(cue);
    seen |= group;
  }
  EXPECT_EQ(seen, kAllCueGroups);
}

}  // namespace
}  // namespace tactus
