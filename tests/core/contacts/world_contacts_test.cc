#include "core/contacts/world_contacts.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(ParseWorldRecipeTest, TakesEveryPart) {
  const auto recipe = ParseWorldRecipe(
      "world:skin=good+measured,contacts=100000,seed=7,poses=no");
  ASSERT_TRUE(recipe.ok()) << recipe.status();
  EXPECT_EQ(recipe->skins, (std::vector<std::string>{"good", "measured"}));
  EXPECT_EQ(recipe->contacts, 100'000u);
  EXPECT_EQ(recipe->seed, 7u);
  EXPECT_FALSE(recipe->poses);
  EXPECT_EQ(recipe->pose_noise_m, std::nullopt);
  EXPECT_TRUE(ParseWorldRecipe("world:").ok());
  EXPECT_DOUBLE_EQ(*ParseWorldRecipe("world:pose-noise=2.5")->pose_noise_m,
                   0.0025);
  EXPECT_EQ(ParseWorldRecipe("world:pose-noise=0")->pose_noise_m, 0);
  EXPECT_TRUE(ParseWorldRecipe("world:pose-noise=100").ok());
}

TEST(ParseWorldRecipeTest, NamesWhatIsWrong) {
  const std::pair<const char*, const char*> kBad[] = {
      {"world:skin=gold", "gold"},
      {"world:skin=ideal+good", "ideal"},
      {"world:contacts=0", "contacts"},
      {"world:contacts=many", "many"},
      {"world:poses=maybe", "poses"},
      {"world:pose-noise=-1", "-1"},
      {"world:pose-noise=100.1", "100.1"},
      {"world:pose-noise=nan", "nan"},
      {"world:pose-noise=", "pose-noise"},
      {"world:pose-noise=1,poses=no", "pose-noise"},
      {"world:pose-noise=1,skin=ideal", "pose-noise"},
      {"world:liftoffs=1.1", "1.1"},
      {"world:liftoffs=nan", "nan"},
      {"world:liftoffs=0.1,skin=ideal", "liftoffs"},
      {"world:colour=red", "colour"},
      {"file.h5", "file.h5"}};
  for (const auto& [text, named] : kBad) {
    const absl::Status status = ParseWorldRecipe(text).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << text;
    EXPECT_NE(status.message().find(named), std::string::npos) << status;
  }
  EXPECT_FALSE(IsWorldRecipe("file.h5"));
}

// How many of the contacts that both recipes felt are not the same.
int CountDifferent(const WorldContacts& a, const WorldContacts& b) {
  int different = 0;
  for (const LabelledContact& contact : a.contacts) {
    const auto same_id =
        std::ranges::find(b.contacts, contact.id, &LabelledContact::id);
    different += same_id != b.contacts.end() &&
                 same_id->object_motion != contact.object_motion;
  }
  return different;
}

TEST(MakeWorldContactsTest, SomeArmsLiftOff) {
  WorldRecipe recipe;
  recipe.contacts = 120;
  recipe.seed = 5;
  const auto none = MakeWorldContacts(recipe, RunSerially);
  recipe.liftoffs = 0.3;
  const auto some = MakeWorldContacts(recipe, RunSerially);
  recipe.liftoffs = 1;
  const auto all = MakeWorldContacts(recipe, RunSerially);
  ASSERT_TRUE(none.ok() && some.ok() && all.ok());
  EXPECT_GT(CountDifferent(*none, *some), 20);
  EXPECT_LT(CountDifferent(*none, *some), 55);
  EXPECT_GT(CountDifferent(*none, *all), 90);
  for (const LabelledContact& contact : all->contacts) {
    // Up to 5 s until the lift-off, up to half of it for the way back.
    EXPECT_LT(contact.frames.size(), 850u);
    EXPECT_FALSE(contact.object_motion.empty());
    EXPECT_EQ(contact.label.back() == 'M',
              contact.object_motion.back() > kMovedM);
  }
}

TEST(MakeWorldContactsTest, ThreadsChangeNothingAndSkinsTakeTurns) {
  WorldRecipe recipe;
  recipe.skins = {"paper", "measured"};
  recipe.contacts = 80;
  const auto one = MakeWorldContacts(recipe, RunSerially);
  const auto two = MakeWorldContacts(recipe, OnThreads(2));
  ASSERT_TRUE(one.ok() && two.ok()) << one.status();
  EXPECT_EQ(one->recorded, (std::vector<uint64_t>{40, 40}));
  EXPECT_EQ(one->contacts.size() + one->never_felt[0] + one->never_felt[1],
            80u);
  ASSERT_EQ(one->contacts.size(), two->contacts.size());
  for (size_t i = 0; i < one->contacts.size(); ++i) {
    const LabelledContact& a = one->contacts[i];
    const LabelledContact& b = two->contacts[i];
    EXPECT_EQ(a.id, b.id);
    ASSERT_EQ(a.frames.size(), b.frames.size());
    EXPECT_EQ(a.frames.features(a.frames.size() - 1),
              b.frames.features(b.frames.size() - 1));
    EXPECT_TRUE(a.with_poses);
    // Even numbers are recorded by the first skin.
    const bool paper = (a.id.back() - '0') % 2 == 0;
    EXPECT_EQ(a.layout.onset_threshold < 1e-3, paper) << a.id;
  }
}

TEST(MakeWorldContactsTest, WithoutPosesMotionIsThatOfTheCentroid) {
  WorldRecipe recipe;
  recipe.contacts = 10;
  recipe.poses = false;
  const auto contacts = MakeWorldContacts(recipe, RunSerially);
  ASSERT_TRUE(contacts.ok());
  for (const LabelledContact& contact : contacts->contacts) {
    EXPECT_FALSE(contact.with_poses);
  }
}

// The noise of the poses is all that differs: the skin feels the same, and the
// motion is as noisy as the poses are.
TEST(MakeWorldContactsTest, PoseNoiseIsTheSameInAllContacts) {
  const auto made = [](std::optional<double> noise_m) {
    WorldRecipe recipe;
    recipe.contacts = 12;
    recipe.pose_noise_m = noise_m;
    auto world = MakeWorldContacts(recipe, RunSerially);
    EXPECT_TRUE(world.ok()) << world.status();
    return std::move(world->contacts);
  };
  const auto feature = [](const LabelledContact& contact, size_t frame,
                          Feature which) {
    return contact.frames.features(frame)[static_cast<int>(which)];
  };
  // Root mean square of the steps of the motion from frame to frame, m.
  const auto roughness = [&](const LabelledContact& contact) {
    double sum = 0;
    for (size_t i = 1; i < contact.frames.size(); ++i) {
      const double step = feature(contact, i, Feature::kMotion) -
                          feature(contact, i - 1, Feature::kMotion);
      sum += step * step;
    }
    return std::sqrt(sum / static_cast<double>(contact.frames.size() - 1));
  };
  const auto drawn = made(std::nullopt);
  const auto none = made(0);
  const auto coarse = made(0.01);
  ASSERT_GT(drawn.size(), 8u);
  ASSERT_EQ(none.size(), drawn.size());
  ASSERT_EQ(coarse.size(), drawn.size());
  for (size_t i = 0; i < drawn.size(); ++i) {
    const size_t last = drawn[i].frames.size() - 1;
    EXPECT_EQ(none[i].id, drawn[i].id);
    for (const Feature which : {Feature::kForce, Feature::kArea}) {
      EXPECT_EQ(feature(none[i], last, which), feature(coarse[i], last, which));
      EXPECT_EQ(feature(none[i], last, which), feature(drawn[i], last, which));
    }
    // Motion along the normal: of two frames, each with 10 mm.
    EXPECT_NEAR(roughness(coarse[i]), 0.01 * std::sqrt(2.0), 0.002);
    EXPECT_LT(roughness(none[i]), 0.001);
  }
}

// The class so far is that of an unmoved object until it has moved by 1 mm,
// and in the end that of the label.
TEST(MakeWorldContactsTest, TheLabelSoFarEndsAsTheLabel) {
  WorldRecipe recipe;
  recipe.skins = {"ideal"};
  recipe.contacts = 200;
  const auto world = MakeWorldContacts(recipe, RunSerially);
  ASSERT_TRUE(world.ok());
  int later = 0;
  for (const LabelledContact& contact : world->contacts) {
    EXPECT_EQ(LabelSoFar(contact, contact.frames.size() - 1), contact.label);
    const std::string first = LabelSoFar(contact, 0);
    EXPECT_EQ(first[0], contact.label[0]);
    EXPECT_EQ(first[1] == 'M', contact.object_motion[0] > 0.001);
    later += first != contact.label;
  }
  EXPECT_GT(later, 20);
}

}  // namespace
}  // namespace tactus::internal
