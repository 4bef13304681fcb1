#include "core/eval/chosen_options.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

using testing::PointersTo;
using testing::SyntheticContacts;

// Small models, so that all presets are fitted quickly.
absl::StatusOr<FitOptions> SmallOptions(absl::string_view preset) {
  absl::StatusOr<FitOptions> options = FitPreset(preset);
  if (options.ok()) {
    options->hmms_per_class = 1;
    options->max_iterations = 3;
    options->lstm.cells = {4};
    options->lstm.training.epochs = 1;
  }
  return options;
}

TEST(ChosenOptionsTest, APresetThatWasNamedIsTaken) {
  const auto contacts = SyntheticContacts(6, 30, 0.05, 1);
  const auto chosen = ChooseOptions(
      PointersTo(contacts),
      {.preset = "paper", .without_poses = true, .options_of = SmallOptions},
      RunSerially);
  ASSERT_TRUE(chosen.ok()) << chosen.status();
  EXPECT_EQ(chosen->preset, "paper");
  EXPECT_FALSE(chosen->choice.has_value());
  EXPECT_EQ(chosen->contacts.size(), contacts.size());
}

TEST(ChosenOptionsTest, WithoutANameItDependsOnThePoses) {
  const auto contacts = SyntheticContacts(6, 30, 0.05, 1);
  const auto with_poses = ChooseOptions(
      PointersTo(contacts), {.options_of = SmallOptions}, RunSerially);
  ASSERT_TRUE(with_poses.ok()) << with_poses.status();
  EXPECT_EQ(with_poses->preset, "tuned");
  EXPECT_FALSE(with_poses->choice.has_value());
  const auto without = ChooseOptions(
      PointersTo(contacts), {.without_poses = true, .options_of = SmallOptions},
      RunSerially);
  ASSERT_TRUE(without.ok()) << without.status();
  ASSERT_TRUE(without->choice.has_value());
  EXPECT_EQ(without->preset, without->choice->name);
  // The contacts are ideal signals, which six presets are not for.
  int unfit = 0;
  for (const ChoiceCandidate& candidate : without->choice->candidates) {
    unfit += !candidate.unfit.empty();
  }
  EXPECT_EQ(unfit, 6);
  // Two with HMMs alone and with an LSTM.
  EXPECT_EQ(without->choice->candidates.size(), 8u + 2u);
}

// Whether `preset` needs the whole skin, with an LSTM on these cues.
bool NeedsIt(const std::string& preset, bool without_poses = false,
             const std::vector<Cue>& lstm_cues = {}) {
  const auto needs = NeedsWholeSkin(
      {.preset = preset,
       .without_poses = without_poses,
       .options_of = [&](absl::string_view name) -> absl::StatusOr<FitOptions> {
         absl::StatusOr<FitOptions> options = FitPreset(name);
         if (options.ok() && !lstm_cues.empty()) options->lstm.cues = lstm_cues;
         return options;
       }});
  EXPECT_TRUE(needs.ok()) << needs.status();
  return needs.ok() && *needs;
}

TEST(ChosenOptionsTest, OnlySomeModelsNeedTheWholeSkin) {
  EXPECT_FALSE(NeedsIt("tuned"));
  EXPECT_FALSE(NeedsIt("tuned", true));
  EXPECT_FALSE(NeedsIt("paper"));
  EXPECT_FALSE(NeedsIt("world"));
  EXPECT_TRUE(NeedsIt("profile"));
  EXPECT_TRUE(NeedsIt("pattern"));
  EXPECT_TRUE(NeedsIt("whole-skin"));
  EXPECT_TRUE(NeedsIt("auto"));
  EXPECT_FALSE(NeedsIt(""));
  EXPECT_TRUE(NeedsIt("", true));
  EXPECT_TRUE(NeedsIt("tuned", false, {NamedCue("skin_spread")}));
  EXPECT_TRUE(NeedsIt("tuned", false, {NamedCue("row_load_0")}));
  EXPECT_EQ(
      ReasonOf(NeedsWholeSkin({.preset = "magic", .options_of = FitPreset})
                   .status()),
      "INVALID_CONFIG");
}

// What ReadForFit asks for when the contacts have poses, or none.
std::vector<bool> Readings(const std::string& preset, bool without_poses) {
  struct Contacts {
    bool without_poses = false;
  };
  std::vector<bool> asked;
  const auto contacts =
      ReadForFit({.preset = preset, .options_of = FitPreset},
                 [&](bool whole_skin) -> absl::StatusOr<Contacts> {
                   asked.push_back(whole_skin);
                   return Contacts{without_poses};
                 });
  EXPECT_TRUE(contacts.ok()) << contacts.status();
  return asked;
}

// Without a name the choice follows from the poses, which only the contacts
// show.
TEST(ChosenOptionsTest, ContactsAreReadAgainIfTheyTurnOutToHaveNoPoses) {
  EXPECT_EQ(Readings("", false), (std::vector<bool>{false}));
  EXPECT_EQ(Readings("", true), (std::vector<bool>{false, true}));
  EXPECT_EQ(Readings("tuned", true), (std::vector<bool>{false}));
  EXPECT_EQ(Readings("pattern", true), (std::vector<bool>{true}));
}

TEST(ChosenOptionsTest, NothingIsReadForAPresetThatIsUnknown) {
  const auto contacts = ReadForFit({.preset = "magic", .options_of = FitPreset},
                                   [](bool) -> absl::StatusOr<OptionsRequest> {
                                     ADD_FAILURE() << "it was read";
                                     return OptionsRequest{};
                                   });
  EXPECT_EQ(ReasonOf(contacts.status()), "INVALID_CONFIG");
}

TEST(ChosenOptionsTest, ContactsThatAreTooShortAreLeftOutIfWanted) {
  auto contacts = SyntheticContacts(6, 30, 0.05, 1);
  const ContactFrame first = contacts[2].frames.front();
  contacts[2].frames.clear();
  contacts[2].frames.push_back(first);
  OptionsRequest request = {.preset = "tuned", .options_of = SmallOptions};
  EXPECT_EQ(ChooseOptions(PointersTo(contacts), request, RunSerially)
                ->contacts.size(),
            contacts.size());
  request.skip_unusable = true;
  const auto chosen = ChooseOptions(PointersTo(contacts), request, RunSerially);
  ASSERT_TRUE(chosen.ok()) << chosen.status();
  EXPECT_EQ(chosen->contacts.size(), contacts.size() - 1);
  EXPECT_EQ(chosen->unusable, std::vector<std::string>{contacts[2].id});
}

TEST(ChosenOptionsTest, AnUnknownPresetIsRefused) {
  const auto contacts = SyntheticContacts(6, 30, 0.05, 1);
  EXPECT_EQ(
      ReasonOf(ChooseOptions(PointersTo(contacts),
                             {.preset = "magic", .options_of = SmallOptions},
                             RunSerially)
                   .status()),
      "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
