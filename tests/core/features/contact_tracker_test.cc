#include "core/features/contact_tracker.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

constexpr auto kNoContact = ContactState::kNoContact;
constexpr auto kInContact = ContactState::kInContact;
constexpr auto kReleased = ContactState::kReleased;

// 6 x 8 taxels of 10 x 20 mm, contact at 1, onset at 2.
SkinLayout MakeLayout(bool wrap = false) {
  SkinLayout layout = testing::FlatLayout(6, 8);
  layout.column_pitch_m = 0.02;
  layout.wrap_columns = wrap;
  layout.onset_threshold = 2;
  return layout;
}

// Feeds a tracker frames with one touched taxel, or none.
class Script {
 public:
  explicit Script(const SkinLayout& layout,
                  ContactTracker::Options options = {.sample_rate_hz = 100,
                                                     .release_after_s = 0.05})
      : layout_(layout), tracker_(layout, options) {}

  const FrameFeatures& Touch(float value, int row = 2, int column = 3,
                             const Pose* pose = nullptr,
                             uint64_t missing_before = 0) {
    std::vector<float> taxels(layout_.taxels());
    taxels[row * layout_.columns + column] = value;
    return tracker_.Step({taxels, pose, missing_before});
  }

  const FrameFeatures& None(const Pose* pose = nullptr,
                            uint64_t missing_before = 0) {
    return Touch(0, 0, 0, pose, missing_before);
  }

  ContactTracker& tracker() { return tracker_; }
  ContactState state() const { return tracker_.state(); }

 private:
  SkinLayout layout_;
  ContactTracker tracker_;
};

void ExpectZero(const FrameFeatures& features) {
  EXPECT_EQ(features.sample().features, (FeatureVector{0, 0, 0}));
  EXPECT_EQ(features.sample().net_force, 0);
  EXPECT_EQ(features.sample().profile, LoadProfile{});
  EXPECT_EQ(features.area_taxels, 0);
  EXPECT_EQ(features.centroid.row, 0);
  EXPECT_EQ(features.centroid.column, 0);
}

TEST(ContactTrackerTest, OnsetNeedsItsThresholdAndContactTheLowerOne) {
  Script script(MakeLayout());
  ExpectZero(script.None());
  EXPECT_EQ(script.state(), kNoContact);
  const FrameFeatures& weak = script.Touch(1.5F);
  EXPECT_EQ(script.state(), kNoContact);
  ExpectZero(weak);
  EXPECT_TRUE(weak.touched);
  EXPECT_EQ(weak.region_count, 1);

  const FrameFeatures& first = script.Touch(2);
  EXPECT_EQ(script.state(), kInContact);
  EXPECT_TRUE(script.tracker().onset());
  EXPECT_EQ(first.max_force, 2);
  EXPECT_EQ(first.area_taxels, 1);
  EXPECT_EQ(first.area_m2, 1e-4);
  EXPECT_EQ(first.motion_m, 0);
  EXPECT_EQ(first.centroid.row, 2);
  EXPECT_EQ(first.centroid.column, 3);

  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(script.Touch(1).max_force, 1);
    EXPECT_EQ(script.state(), kInContact);
    EXPECT_FALSE(script.tracker().onset());
  }
}

TEST(ContactTrackerTest, OnsetMayComeFromASmallRegion) {
  const SkinLayout layout = MakeLayout();
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels());
  taxels[0] = taxels[1] = 1;
  taxels[20] = 3;
  const FrameFeatures& features = tracker.Step({taxels});
  EXPECT_TRUE(tracker.onset());
  EXPECT_EQ(features.region_count, 2);
  EXPECT_EQ(features.area_taxels, 2);
  EXPECT_EQ(features.max_force, 1);
}

TEST(ContactTrackerTest, ShortLossKeepsTheContactAndItsPlace) {
  Script script(MakeLayout());
  script.Touch(5, 2, 3);
  script.Touch(5, 4, 3);
  for (int i = 0; i < 4; ++i) {
    const FrameFeatures& lost = script.None();
    EXPECT_EQ(script.state(), kInContact);
    EXPECT_FALSE(lost.touched);
    EXPECT_EQ(lost.max_force, 0);
    EXPECT_EQ(lost.area_taxels, 0);
    EXPECT_EQ(lost.area_m2, 0);
    EXPECT_NEAR(lost.motion_m, 0.02, 1e-15);
    EXPECT_EQ(lost.centroid.row, 4);
  }
  // The count starts anew with each loss.
  EXPECT_NEAR(script.Touch(1, 5, 3).motion_m, 0.03, 1e-15);
  EXPECT_FALSE(script.tracker().onset());
  for (int i = 0; i < 4; ++i) script.None();
  EXPECT_EQ(script.state(), kInContact);
}

TEST(ContactTrackerTest, LongLossReleasesAndTheNextOnsetStartsAnew) {
  Script script(MakeLayout());
  script.Touch(5, 0, 0);
  script.Touch(5, 4, 0);
  for (int i = 0; i < 4; ++i) script.None();
  ExpectZero(script.None());
  EXPECT_EQ(script.state(), kReleased);
  EXPECT_TRUE(script.tracker().released());
  for (int i = 0; i < 10; ++i) {
    ExpectZero(script.Touch(1.5F));
    EXPECT_EQ(script.state(), kReleased);
    EXPECT_FALSE(script.tracker().released());
  }
  const FrameFeatures& second = script.Touch(2, 5, 7);
  EXPECT_EQ(script.state(), kInContact);
  EXPECT_TRUE(script.tracker().onset());
  EXPECT_EQ(second.motion_m, 0);
  EXPECT_NEAR(script.Touch(2, 5, 6).motion_m, 0.02, 1e-15);
}

TEST(ContactTrackerTest, FramesThatWentMissingCountAsLost) {
  struct Case {
    // Missing before the first and the second untouched frame.
    uint64_t first, second;
    bool released;
  };
  constexpr uint64_t kHuge = std::numeric_limits<uint64_t>::max();
  const Case cases[] = {{0, 0, false},    {0, 2, false}, {0, 3, true},
                        {2, 0, false},    {3, 0, true},  {kHuge, 0, true},
                        {0, kHuge, true}, {1, 1, false}, {2, 1, true}};
  for (const Case& c : cases) {
    Script script(MakeLayout());
    script.Touch(5);
    script.None(nullptr, c.first);
    script.None(nullptr, c.second);
    EXPECT_EQ(script.state(), c.released ? kReleased : kInContact)
        << c.first << " " << c.second;
  }
}

TEST(ContactTrackerTest, FramesMissingBetweenTouchedOnesDoNotRelease) {
  Script script(MakeLayout());
  script.Touch(5);
  script.Touch(5, 2, 3, nullptr, 1'000'000);
  EXPECT_EQ(script.state(), kInContact);
  EXPECT_FALSE(script.tracker().onset());
}

// The release is reported even if the skin is touched again by then; the new
// contact begins with the next frame.
TEST(ContactTrackerTest, LossThatEndsInMissingFramesReleases) {
  Script script(MakeLayout());
  script.Touch(5);
  script.None();
  ExpectZero(script.Touch(5, 2, 3, nullptr, 4));
  EXPECT_EQ(script.state(), kReleased);
  EXPECT_TRUE(script.tracker().released());
  EXPECT_FALSE(script.tracker().onset());
  script.Touch(5);
  EXPECT_TRUE(script.tracker().onset());
}

TEST(ContactTrackerTest, ReleaseTimeIsInSecondsAtTheSampleRate) {
  struct Case {
    double rate, after;
    int frames;
  };
  const Case cases[] = {{100, 0.5, 50}, {100, 0.07, 7}, {1000, 0.5, 500},
                        {30, 0.5, 15},  {100, 0, 1},    {100, 0.001, 1},
                        {100, 0.051, 6}};
  for (const Case& c : cases) {
    Script script(MakeLayout(),
                  {.sample_rate_hz = c.rate, .release_after_s = c.after});
    script.Touch(5);
    for (int i = 1; i < c.frames; ++i) {
      script.None();
      ASSERT_EQ(script.state(), kInContact) << c.rate << " " << c.after;
    }
    script.None();
    EXPECT_EQ(script.state(), kReleased) << c.rate << " " << c.after;
  }
}

TEST(ContactTrackerTest, NegativeReleaseTimeMeansNever) {
  Script script(MakeLayout(), {.sample_rate_hz = 100, .release_after_s = -1});
  script.Touch(5);
  constexpr uint64_t kHuge = std::numeric_limits<uint64_t>::max();
  for (int i = 0; i < 1'000; ++i) script.None(nullptr, kHuge);
  EXPECT_EQ(script.state(), kInContact);
}

TEST(ContactTrackerTest, MotionWithPosesIsAlongTheNormalInTheWorld) {
  Script script(MakeLayout());
  // The skin's normal, z in the link, points along x.
  Pose pose;
  pose.orientation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d(0, 1, 0));
  pose.position = {1, 2, 3};
  script.Touch(5, 0, 0, &pose);
  pose.position.x() += 0.003;
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, 0.003, 1e-12);
  pose.position.x() -= 0.007;
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, -0.004, 1e-12);
  // Neither a link that slides along the skin nor a contact that does.
  pose.position += Eigen::Vector3d(0, 0.05, -0.04);
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, -0.004, 1e-12);
  EXPECT_NEAR(script.Touch(5, 3, 2, &pose).motion_m, -0.004, 1e-12);
}

// Ten poses, half of them 1 mm too far and half too near, the onset's too far.
TEST(ContactTrackerTest, MotionBeginsAtTheMeanOfNoisyPoses) {
  Script script(MakeLayout());
  Pose pose;
  for (int i = 0; i < 9; ++i) {
    pose.position.z() = i % 2 == 0 ? 0.999 : 1.001;
    script.None(&pose);
  }
  pose.position.z() = 1.001;
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, 0.001, 1e-12);
  pose.position.z() = 0.999;
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, -0.001, 1e-12);
}

// A hard, fixed object: the region grows to one side while the link rests, so
// its centroid shifts although nothing moved. Without poses only the centroid
// is known, so its shift counts as motion.
TEST(ContactTrackerTest, WithPosesGrowthIsNotTravel) {
  const SkinLayout layout = MakeLayout();
  std::vector<float> taxels(layout.taxels());
  Pose pose;
  ContactTracker with_pose(layout, {});
  ContactTracker without(layout, {});
  taxels[0] = 5;
  with_pose.Step({.taxels = taxels, .pose = &pose});
  without.Step({.taxels = taxels});
  taxels[1] = 5;
  EXPECT_EQ(with_pose.Step({.taxels = taxels, .pose = &pose}).motion_m, 0);
  EXPECT_GT(without.Step({.taxels = taxels}).motion_m, 0);
  EXPECT_EQ(with_pose.features().centroid.column, 0.5);
  // The link's own motion counts in full meanwhile.
  pose.position.z() += 0.004;
  EXPECT_NEAR(with_pose.Step({.taxels = taxels, .pose = &pose}).motion_m, 0.004,
              1e-15);
}

// The region has grown away from the taxel of the onset, whose place it holds.
TEST(ContactTrackerTest, ALongRegionHasNotTravelled) {
  const SkinLayout layout = MakeLayout(/*wrap=*/true);
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels());
  Pose pose;
  taxels[0] = 5;
  tracker.Step({.taxels = taxels, .pose = &pose});
  for (int row = 0; row < 6; ++row) taxels[row * 8] = 5;
  for (int row = 3; row < 6; ++row) taxels[row * 8 + 1] = 5;
  pose.position.x() += 0.004;
  EXPECT_NEAR(tracker.Step({.taxels = taxels, .pose = &pose}).motion_m, 0.004,
              1e-15);
  EXPECT_EQ(tracker.features().centroid.row, 3);
  // Only the larger one of two regions counts.
  for (int row = 1; row < 3; ++row) taxels[row * 8] = 0;
  EXPECT_LT(tracker.Step({.taxels = taxels, .pose = &pose}).motion_m, 0.003);
}

TEST(ContactTrackerTest, MotionWithPosesFollowsRotation) {
  Script script(MakeLayout());
  Pose pose;
  script.Touch(5, 0, 5, &pose);
  // 0.1 m from the axis: a turn by 0.3 rad lifts it by 0.1 sin(0.3).
  pose.orientation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(0, -1, 0));
  EXPECT_NEAR(script.Touch(5, 0, 5, &pose).motion_m, 0.1 * std::sin(0.3),
              1e-12);
  // A link that turns about the place of the contact does not move it.
  pose.position = {0.1 - 0.1 * std::cos(0.3), 0, -0.1 * std::sin(0.3)};
  EXPECT_NEAR(script.Touch(5, 0, 5, &pose).motion_m, 0, 1e-12);
}

// A cylinder rolls over an object at rest: a quarter turn moves the contact by
// a quarter of the columns, and its axis not at all.
TEST(ContactTrackerTest, ALinkThatTurnsUnderAnObjectDoesNotMove) {
  Script script(MakeLayout(/*wrap=*/true));
  Pose pose;
  script.Touch(5, 0, 7, &pose);
  pose.orientation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d(0, 0, -1));
  EXPECT_NEAR(script.Touch(5, 0, 1, &pose).motion_m, 0, 1e-12);
}

TEST(ContactTrackerTest, WhileTouchIsLostThePlaceMovesWithThePose) {
  Script script(MakeLayout());
  Pose pose;
  script.Touch(5, 0, 0, &pose);
  script.Touch(5, 0, 1, &pose);
  pose.position = {0, 0, 0.01};
  EXPECT_NEAR(script.None(&pose).motion_m, 0.01, 1e-12);
  // A frame without its pose rests at the last one.
  EXPECT_NEAR(script.None().motion_m, 0.01, 1e-12);
}

TEST(ContactTrackerTest, EachContactUsesItsOwnOnsetPose) {
  Script script(MakeLayout());
  Pose pose;
  script.Touch(5, 0, 0, &pose);
  for (int i = 0; i < 5; ++i) script.None(&pose);
  ASSERT_EQ(script.state(), kReleased);
  pose.position = {7, 0, 0};
  EXPECT_EQ(script.Touch(5, 0, 0, &pose).motion_m, 0);
  pose.position = {7, 0, 0.5};
  EXPECT_NEAR(script.Touch(5, 0, 0, &pose).motion_m, 0.5, 1e-12);
}

TEST(ContactTrackerTest, TravelOnAWrappedSkinCrossesTheSeam) {
  Script script(MakeLayout(/*wrap=*/true));
  script.Touch(5, 0, 6);
  EXPECT_NEAR(script.Touch(5, 0, 7).motion_m, 0.02, 1e-12);
  EXPECT_NEAR(script.Touch(5, 0, 0).motion_m, 0.04, 1e-12);
  EXPECT_NEAR(script.Touch(5, 0, 1).motion_m, 0.06, 1e-12);
  // Half the circumference is the largest distance.
  EXPECT_NEAR(script.Touch(5, 0, 2).motion_m, 0.08, 1e-12);
  EXPECT_NEAR(script.Touch(5, 0, 3).motion_m, 0.06, 1e-12);
}

// A quarter of the way round, the skin lies a radius lower.
TEST(ContactTrackerTest, TravelOnACylinderWithPosesIsItsDepth) {
  const SkinLayout layout = MakeLayout(/*wrap=*/true);
  Script script(layout);
  Pose pose;
  script.Touch(5, 0, 7, &pose);
  EXPECT_NEAR(script.Touch(5, 0, 1, &pose).motion_m, -layout.CylinderRadius(),
              1e-12);
}

TEST(ContactTrackerTest, MaskedTaxelsNeverBeginAContact) {
  SkinLayout layout = MakeLayout();
  layout.mask.assign(layout.taxels(), 1);
  layout.mask[2 * 8 + 3] = 0;
  Script script(layout);
  EXPECT_FALSE(script.Touch(1e6F).touched);
  EXPECT_EQ(script.state(), kNoContact);
}

TEST(ContactTrackerTest, FullSkinAndCheckerboard) {
  const SkinLayout layout = MakeLayout();
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels(), 4);
  EXPECT_EQ(tracker.Step({taxels}).area_taxels, 48);
  EXPECT_EQ(tracker.features().area_m2, 48 * 1e-4);
  EXPECT_EQ(tracker.features().centroid.row, 2.5);
  EXPECT_EQ(tracker.features().centroid.column, 3.5);
  for (int i = 0; i < layout.taxels(); ++i) {
    if ((i / 8 + i) % 2 == 0) taxels[i] = 0;
  }
  EXPECT_EQ(tracker.Step({taxels}).area_taxels, 24);
  EXPECT_EQ(tracker.features().region_count, 1);
  EXPECT_NEAR(tracker.features().motion_m, 0, 1e-15);
}

TEST(ContactTrackerTest, LoadProfileMayBeLeftOut) {
  const SkinLayout layout = MakeLayout();
  const std::vector<float> taxels(layout.taxels(), 4);
  ContactTracker with(layout, {});
  ContactTracker without(layout, {.load_profile = false});
  EXPECT_GT(with.Step({taxels}).profile[0], 0);
  EXPECT_EQ(without.Step({taxels}).profile, LoadProfile{});
  EXPECT_EQ(without.features().net_force, with.features().net_force);
}

TEST(ContactTrackerTest, ResetIsLikeNew) {
  Script script(MakeLayout());
  script.Touch(5, 0, 0);
  script.Touch(5, 0, 1);
  script.tracker().Reset();
  EXPECT_EQ(script.state(), kNoContact);
  EXPECT_FALSE(script.tracker().onset());
  ExpectZero(script.tracker().features());
  EXPECT_EQ(script.Touch(5, 3, 3).motion_m, 0);
  EXPECT_TRUE(script.tracker().onset());
}

TEST(ContactTrackerTest, StepAllocatesNothing) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  ContactTracker tracker(layout,
                         {.sample_rate_hz = 100, .release_after_s = 0.02});
  Random random(5);
  std::vector<float> taxels(layout.taxels());
  const Pose pose;
  int onsets = 0;
  int releases = 0;
  const testing::AllocationCounter allocations;
  for (int i = 0; i < 2'000; ++i) {
    const double density = i / 5 % 2 == 0 ? random.Uniform() : 0;
    for (float& taxel : taxels) {
      taxel = random.Uniform() < density ? 1.0F : 0.0F;
    }
    tracker.Step({taxels, i % 3 == 0 ? nullptr : &pose});
    onsets += tracker.onset();
    releases += tracker.released();
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_GT(onsets, 100);
  EXPECT_GT(releases, 100);
}

}  // namespace
}  // namespace tactus::internal
