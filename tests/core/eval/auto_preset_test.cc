#include "core/eval/auto_preset.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus {
namespace {

using testing::PointersTo;
using testing::SyntheticContacts;

FitOptions HmmOf(std::vector<Cue> cues) {
  FitOptions options;
  options.hmm_cues = std::move(cues);
  options.log_features = false;
  options.states = 2;
  options.max_iterations = 3;
  // Not trained to choose, but kept.
  options.lstm.networks = 1;
  return options;
}

// Classes differ by force alone. Motion tells nothing once it is noise.
std::vector<LabelledContact> ForceContacts(int per_class) {
  auto contacts = SyntheticContacts(per_class, 30, 0.05, 1);
  Random random(7);
  for (LabelledContact& contact : contacts) {
    for (size_t t = 0; t < contact.frames.size(); ++t) {
      ContactFrame frame = contact.frames[t];
      frame.sample.features[static_cast<int>(Feature::kMotion)] =
          random.Uniform();
      contact.frames.Set(t, frame);
    }
  }
  return contacts;
}

TEST(AutoPresetTest, TheBetterCandidateIsChosen) {
  const auto contacts = ForceContacts(12);
  const FitOptions good = HmmOf({Cue::kForce});
  const FitOptions bad = HmmOf({Cue::kMotion});
  for (const bool good_first : {true, false}) {
    std::vector<std::pair<std::string, FitOptions>> candidates = {
        {"good", good}, {"bad", bad}};
    if (!good_first) std::swap(candidates[0], candidates[1]);
    const auto choice =
        ChoosePreset(PointersTo(contacts), candidates, RunSerially);
    ASSERT_TRUE(choice.ok()) << choice.status();
    EXPECT_EQ(choice->name, "good");
    EXPECT_EQ(choice->options.hmm_cues, good.hmm_cues);
    EXPECT_EQ(choice->options.lstm.networks, 1);
    EXPECT_TRUE(choice->options.calibrate);
    EXPECT_EQ(choice->contacts, 48);
    EXPECT_EQ(choice->chance, 0.25);
    // The conditions "slow" and "fast".
    EXPECT_TRUE(choice->by_condition);
    EXPECT_EQ(choice->folds, 2);
    ASSERT_EQ(choice->right.size(), 2u);
    EXPECT_EQ(choice->right[0].first, candidates[0].first);
    // More than chance, although the conditions scale the force.
    EXPECT_GT(choice->nearest_right, 12);
  }
}

TEST(AutoPresetTest, ACandidateThatDoesNotSuitIsLeftOut) {
  const auto contacts = ForceContacts(6);
  const auto choice = ChoosePreset(
      PointersTo(contacts),
      {{"profile", *FitPreset("profile")}, {"force", HmmOf({Cue::kForce})}},
      RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  EXPECT_EQ(choice->name, "force");
  EXPECT_EQ(choice->right.size(), 1u);
  ASSERT_EQ(choice->unfit.size(), 1u);
  EXPECT_EQ(choice->unfit[0].first, "profile");
  EXPECT_NE(choice->unfit[0].second.find("ideal signals"), std::string::npos);
  EXPECT_EQ(
      ReasonOf(ChoosePreset(PointersTo(contacts),
                            {{"profile", *FitPreset("profile")}}, RunSerially)
                   .status()),
      "INVALID_TRAINING_DATA");
}

// A condition of one class alone cannot be left out.
TEST(AutoPresetTest, ConditionsThatHoldAClassAreNotLeftOut) {
  auto contacts = ForceContacts(6);
  for (LabelledContact& contact : contacts) contact.condition = contact.label;
  const auto choice = ChoosePreset(
      PointersTo(contacts), {{"force", HmmOf({Cue::kForce})}}, RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  EXPECT_FALSE(choice->by_condition);
  EXPECT_EQ(choice->folds, 3);
}

TEST(AutoPresetTest, TooFewContactsAreRefused) {
  const auto contacts = ForceContacts(2);
  EXPECT_EQ(
      ReasonOf(ChoosePreset(PointersTo(contacts),
                            {{"force", HmmOf({Cue::kForce})}}, RunSerially)
                   .status()),
      "INVALID_TRAINING_DATA");
  EXPECT_EQ(ReasonOf(ChoosePreset({}, {}, RunSerially).status()),
            "INVALID_TRAINING_DATA");
}

}  // namespace
}  // namespace tactus
