#include "tools/trainctl/data/simulate_jobs.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

SimulateFlags RandomFlags() {
  SimulateFlags flags;
  flags.protocol = "random";
  flags.skin = "good";
  flags.contacts = 3;
  return flags;
}

TEST(SimulateJobsTest, RandomTrialsHaveAsManyTouchesAsAskedFor) {
  for (const SceneOptions& scene :
       {SceneOptions{}, SceneOptions{.touches = 2, .touch_s = 0.5},
        SceneOptions{.touch_s = 0.5, .objects = 3}}) {
    SimulateFlags flags = RandomFlags();
    flags.scene = scene;
    const SkinLayout layout = *LayoutOf(flags);
    const auto jobs = MakeJobs(flags, layout);
    ASSERT_TRUE(jobs.ok()) << jobs.status();
    ASSERT_EQ(jobs->count, 3);
    const auto sensed = jobs->run(2);
    ASSERT_TRUE(sensed.ok()) << sensed.status();
    ASSERT_EQ(sensed->size(), 1);
    const Trial& trial = sensed->front().trial;
    EXPECT_EQ(trial.id, "000002");
    const int several = std::max(scene.touches, scene.objects);
    EXPECT_EQ(trial.touches.size(), several > 1 ? several : 0);
  }
}

TEST(SimulateJobsTest, ContactsOfASceneAlone) {
  SimulateFlags flags = RandomFlags();
  flags.scene = {.touch_s = 0.5, .objects = 3};
  const SkinLayout layout = *LayoutOf(flags);
  const auto together = MakeJobs(flags, layout)->run(2);
  flags.alone = true;
  const auto alone = MakeJobs(flags, layout)->run(2);
  ASSERT_TRUE(together.ok() && alone.ok());
  const std::vector<Touch>& touches = together->front().trial.touches;
  ASSERT_EQ(alone->size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const Trial& trial = (*alone)[i].trial;
    EXPECT_EQ(trial.id, absl::StrFormat("%06d", 6 + i));
    ASSERT_EQ(trial.touches.size(), 1u);
    const Touch& touch = trial.touches.front();
    // It may move where it did not, because nothing else holds the arm back.
    EXPECT_EQ(touch.object, touches[i].object);
    EXPECT_EQ(touch.label[0], touches[i].label[0]);
    EXPECT_EQ(touch.centre->row, touches[i].centre->row);
    EXPECT_EQ(touch.centre->column, touches[i].centre->column);
  }
}

TEST(SimulateJobsTest, BadCombinationsAreNamed) {
  const struct {
    void (*spoil)(SimulateFlags&);
    const char* field;
  } cases[] = {
      {[](SimulateFlags& f) { f.scene.touches = 0; }, "touches"},
      {[](SimulateFlags& f) { f.scene.objects = 5; }, "objects"},
      {[](SimulateFlags& f) { f.scene.gap_s = -1; }, "gap"},
      {[](SimulateFlags& f) {
         f.scene.touches = 2;
         f.protocol = "paper";
       },
       "--protocol with --touches or --objects"},
      {[](SimulateFlags& f) {
         f.scene.objects = 2;
         f.protocol = "cody";
       },
       "--protocol with --touches or --objects"},
      {[](SimulateFlags& f) { f.alone = true; }, "--alone"},
  };
  for (const auto& c : cases) {
    SimulateFlags flags = RandomFlags();
    c.spoil(flags);
    const SkinLayout layout = *LayoutOf(flags);
    const auto jobs = MakeJobs(flags, layout);
    EXPECT_EQ(ReasonOf(jobs.status()), "INVALID_CONFIG") << c.field;
    EXPECT_EQ(InfoOf(jobs.status()).metadata().at("field"), c.field);
  }
}

}  // namespace
}  // namespace tactus::internal::client
