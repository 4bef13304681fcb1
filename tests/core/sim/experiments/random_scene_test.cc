#include "core/sim/experiments/random_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/errors.h"
#include "core/skin/geometry.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

SkinModel NoiseFree() {
  SkinModel skin = *SkinModelNamed("good");
  skin.noise_n = 0;
  skin.step_n = 0;
  skin.pose_noise_min_m = skin.pose_noise_max_m = 1e-12;
  skin.pose_gain_error_max = 0;
  return skin;
}

double Load(const Trial& trial, size_t frame) {
  std::vector<float> taxels(384);
  trial.taxels.Decode(frame, taxels.data());
  return std::accumulate(taxels.begin(), taxels.end(), 0.0);
}

size_t FrameOf(double time) {
  return static_cast<size_t>(std::lround(time * 100));
}

// Object and place of a touch.
std::string Key(const Touch& touch) {
  return touch.object + "@" + std::to_string(touch.centre->row);
}

TEST(SceneTrialTest, TheGapIsExactAndTheTruthIsTheLoad) {
  const SkinModel skin = NoiseFree();
  std::set<std::string> labels;
  for (const double gap : {0.03, 0.25, 1.0}) {
    const SceneOptions options = {.touches = 3, .gap_s = gap, .touch_s = 1};
    for (uint64_t n = 0; n < 40; ++n) {
      const auto trial = SceneTrial(skin, options, 5, n);
      ASSERT_TRUE(trial.ok()) << trial.status();
      ASSERT_TRUE(Validate(*trial, "here").ok()) << Validate(*trial, "here");
      ASSERT_EQ(trial->touches.size(), 3);
      EXPECT_EQ(trial->label, trial->touches[0].label);
      size_t last = 0;
      for (const Touch& touch : trial->touches) {
        labels.insert(touch.label);
        const size_t begin = FrameOf(touch.begin_s);
        const size_t end = FrameOf(touch.end_s);
        if (last > 0) {
          EXPECT_EQ(begin - last - 1, FrameOf(gap));
        }
        EXPECT_GT(Load(*trial, begin), 0);
        EXPECT_GT(Load(*trial, end), 0);
        for (size_t t = last == 0 ? 0 : last + 1; t < begin; ++t) {
          ASSERT_EQ(Load(*trial, t), 0) << n << " frame " << t;
        }
        EXPECT_EQ(touch.label[1] == 'M', touch.object_motion.back() > 0.001);
        last = end;
      }
      ASSERT_EQ(trial->time.size(), last + 101);
      for (size_t t = last + 1; t < trial->time.size(); ++t) {
        ASSERT_EQ(Load(*trial, t), 0);
      }
    }
  }
  EXPECT_EQ(labels.size(), 4);
}

// Between two frames the arm never moves further than at 1 m/s.
TEST(SceneTrialTest, PosesAreContinuous) {
  const SkinModel skin = NoiseFree();
  for (const SceneOptions& options :
       {SceneOptions{.touches = 4, .gap_s = 0.1, .touch_s = 1},
        SceneOptions{.objects = 4}}) {
    for (uint64_t n = 0; n < 40; ++n) {
      const auto trial = SceneTrial(skin, options, 6, n);
      ASSERT_TRUE(trial.ok()) << trial.status();
      for (size_t t = 1; t < trial->poses.size(); ++t) {
        ASSERT_LT(
            (trial->poses[t].position - trial->poses[t - 1].position).norm(),
            0.01)
            << n << " frame " << t;
      }
      EXPECT_LT((trial->poses.back().position -
                 trial->poses[trial->poses.size() - 20].position)
                    .norm(),
                1e-9);
    }
  }
}

TEST(SceneTrialTest, ObjectsOverlapInTime) {
  const SkinModel skin = NoiseFree();
  int overlaps = 0;
  int pairs = 0;
  for (uint64_t n = 0; n < 60; ++n) {
    const auto trial = SceneTrial(skin, {.objects = 3}, 7, n);
    ASSERT_TRUE(trial.ok()) << trial.status();
    ASSERT_TRUE(Validate(*trial, "here").ok()) << Validate(*trial, "here");
    ASSERT_EQ(trial->touches.size(), 3);
    // The first frames may have less load than counts.
    EXPECT_GE(FrameOf(trial->touches[0].begin_s), 100);
    EXPECT_LE(FrameOf(trial->touches[0].begin_s), 103);
    for (int i = 1; i < 3; ++i) {
      ++pairs;
      overlaps += trial->touches[i].begin_s <= trial->touches[0].end_s;
      EXPECT_LE(trial->touches[i].begin_s, 3.03);
    }
    // A frame has a load exactly when some touch of the truth may have one.
    for (size_t t = 0; t < trial->time.size(); ++t) {
      const bool inside =
          std::ranges::any_of(trial->touches, [&](const Touch& touch) {
            return t >= FrameOf(touch.begin_s) && t <= FrameOf(touch.end_s);
          });
      if (!inside) {
        ASSERT_EQ(Load(*trial, t), 0) << n << " frame " << t;
      }
    }
  }
  EXPECT_GT(overlaps, 0.8 * pairs);
}

// How far the link gets along the normal of `centre`, m.
double Reach(const Trial& trial, const SkinLayout& layout,
             const SkinPoint& centre) {
  const Eigen::Vector3d normal = LinkNormal(layout, centre);
  double reach = 0;
  for (const Pose& pose : trial.poses) {
    reach = std::max(reach, normal.dot(pose.position));
  }
  return reach;
}

// Each of the objects holds the arm back, so with all it gets no further than
// with one.
TEST(SceneTrialTest, ObjectsHoldTheArmBackFromEachOther) {
  const SkinModel skin = NoiseFree();
  int held = 0;
  for (uint64_t n = 0; n < 30; ++n) {
    const auto together = SceneTrial(skin, {.objects = 2}, 8, n);
    const auto alone = SceneTrialsAlone(skin, {.objects = 2}, 8, n);
    ASSERT_TRUE(together.ok() && alone.ok()) << together.status();
    ASSERT_EQ(alone->size(), 2);
    // The arm moves along the normal of the object that it touches first.
    const Touch& first = alone->front().touches.front();
    const double reach = Reach(*together, skin.layout, *first.centre);
    for (const Trial& trial : *alone) {
      ASSERT_EQ(trial.touches.size(), 1);
      const Touch& touch = trial.touches.front();
      EXPECT_TRUE(std::ranges::any_of(
          together->touches,
          [&](const Touch& other) { return Key(other) == Key(touch); }));
      const double free = Reach(trial, skin.layout, *touch.centre);
      EXPECT_LE(reach, free + 1e-5) << n;
      held += reach < 0.8 * free;
    }
  }
  EXPECT_GT(held, 20);
}

TEST(SceneTrialTest, SameSeedSameBitsOtherNumberOtherScene) {
  const SkinModel skin = *SkinModelNamed("measured");
  for (const SceneOptions& options :
       {SceneOptions{.touches = 2, .touch_s = 0.5},
        SceneOptions{.objects = 2}}) {
    const Trial a = *SceneTrial(skin, options, 1, 3);
    const Trial b = *SceneTrial(skin, options, 1, 3);
    const Trial c = *SceneTrial(skin, options, 1, 4);
    const Trial d = *SceneTrial(skin, options, 2, 3);
    EXPECT_EQ(a.taxels.u16, b.taxels.u16);
    EXPECT_EQ(a.touches[1].object_motion, b.touches[1].object_motion);
    EXPECT_EQ(a.poses.back().position, b.poses.back().position);
    EXPECT_EQ(std::set<std::string>({Key(a.touches[0]), Key(a.touches[1]),
                                     Key(c.touches[0]), Key(c.touches[1]),
                                     Key(d.touches[0]), Key(d.touches[1])})
                  .size(),
              6);
  }
}

TEST(SceneTrialTest, EachBadOptionIsNamed) {
  const struct {
    SceneOptions options;
    const char* field;
  } cases[] = {{{.touches = 0}, "touches"},
               {{.touches = 65}, "touches"},
               {{.gap_s = 0.001}, "gap"},
               {{.gap_s = std::nan("")}, "gap"},
               {{.touch_s = 0}, "touch-seconds"},
               {{.objects = 5}, "objects"},
               {{.touches = 2, .objects = 2}, "objects with several touches"}};
  for (const auto& c : cases) {
    const auto trial = SceneTrial(NoiseFree(), c.options, 1, 1);
    EXPECT_EQ(ReasonOf(trial.status()), "INVALID_CONFIG") << c.field;
    EXPECT_EQ(InfoOf(trial.status()).metadata().at("field"), c.field);
  }
}

}  // namespace
}  // namespace tactus::internal
