#include "core/eval/auto_preset.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/eval/choice_proto.h"
#include "core/inputs/inputs.h"
#include "core/train/lstm_work.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"
#include "tests/support/pattern_contacts.h"

namespace tactus::internal {
namespace {

using testing::PointersTo;
using testing::SyntheticContacts;

FitOptions HmmOf(std::vector<Cue> cues) {
  FitOptions options;
  options.hmm_cues = std::move(cues);
  options.log_features = false;
  options.states = 2;
  options.max_iterations = 3;
  options.lstm.cues = options.hmm_cues;
  options.lstm.cells = {4};
  options.lstm.training.epochs = 2;
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

// What compares them with HMMs alone.
ChoiceRequest Hmms(std::vector<std::pair<std::string, FitOptions>> presets) {
  return {.presets = std::move(presets), .work_limit = 0};
}

std::vector<std::string> Compared(const PresetChoice& choice) {
  std::vector<std::string> names;
  for (const ChoiceCandidate& candidate : choice.candidates) {
    if (candidate.unfit.empty()) names.push_back(candidate.preset);
  }
  return names;
}

TEST(AutoPresetTest, TheBetterCandidateIsChosen) {
  const auto contacts = ForceContacts(12);
  const FitOptions good = HmmOf({Cue::kForce});
  const FitOptions bad = HmmOf({Cue::kMotion});
  for (const bool good_first : {true, false}) {
    std::vector<std::pair<std::string, FitOptions>> presets = {{"good", good},
                                                               {"bad", bad}};
    if (!good_first) std::swap(presets[0], presets[1]);
    const auto choice =
        ChoosePreset(PointersTo(contacts), Hmms(presets), RunSerially);
    ASSERT_TRUE(choice.ok()) << choice.status();
    EXPECT_EQ(choice->name, "good");
    EXPECT_EQ(choice->options.hmm_cues, good.hmm_cues);
    EXPECT_EQ(choice->options.lstm.networks, 0);
    EXPECT_TRUE(choice->options.calibrate);
    EXPECT_EQ(choice->contacts, 48);
    EXPECT_EQ(choice->chance, 0.25);
    EXPECT_EQ(Compared(*choice),
              (std::vector<std::string>{presets[0].first, presets[1].first}));
    // More than chance, although the conditions scale the force.
    EXPECT_GT(choice->nearest_right, 12);
  }
}

TEST(AutoPresetTest, ACandidateThatDoesNotSuitIsLeftOut) {
  const auto contacts = ForceContacts(6);
  const auto choice = ChoosePreset(PointersTo(contacts),
                                   Hmms({{"profile", *FitPreset("profile")},
                                         {"force", HmmOf({Cue::kForce})}}),
                                   RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  EXPECT_EQ(choice->name, "force");
  EXPECT_EQ(Compared(*choice), std::vector<std::string>{"force"});
  EXPECT_EQ(choice->candidates[0].preset, "profile");
  EXPECT_NE(choice->candidates[0].unfit.find("ideal signals"),
            std::string::npos);
  const auto none =
      ChoosePreset(PointersTo(contacts),
                   Hmms({{"profile", *FitPreset("profile")}}), RunSerially);
  EXPECT_EQ(ReasonOf(none.status()), "INVALID_TRAINING_DATA");
  EXPECT_NE(none.status().message().find("profile: "), absl::string_view::npos);
}

TEST(AutoPresetTest, OfEquallyGoodOnesTheCheaperIsChosen) {
  const auto contacts = testing::ContactsByPattern();
  FitOptions pattern = *FitPreset("pattern");
  pattern.hmms_per_class = 1;
  const FitOptions ridge = *FitPreset("ridge");
  const FitOptions nearest = *FitPreset("nearest");
  const auto choice = ChoosePreset(
      PointersTo(contacts),
      Hmms({{"nearest", nearest}, {"ridge", ridge}, {"pattern", pattern}}),
      RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  ASSERT_EQ(Compared(*choice),
            (std::vector<std::string>{"nearest", "ridge", "pattern"}));
  for (const ChoiceCandidate& candidate : choice->candidates) {
    if (candidate.networks > 0) continue;
    EXPECT_GE(candidate.right, 34) << candidate.preset;
  }
  EXPECT_EQ(choice->name, "pattern");
}

TEST(AutoPresetTest, WhatIsClearlyBetterIsChosenAtAnyCost) {
  const auto contacts = testing::ContactsByPattern();
  // The force alone says nothing here.
  const auto choice = ChoosePreset(PointersTo(contacts),
                                   Hmms({{"force", HmmOf({Cue::kForce})},
                                         {"nearest", *FitPreset("nearest")}}),
                                   RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  EXPECT_EQ(choice->name, "nearest");
  EXPECT_EQ(choice->options.learner, Learner::kNearest);
}

TEST(AutoPresetTest, AChoiceGoesOverTheWireAndBack) {
  PresetChoice choice;
  choice.name = "ridge";
  choice.options.learner = Learner::kRidge;
  choice.candidates = {{"pattern", 0, Learner::kHmms, 20},
                       {"ridge", 0, Learner::kRidge, 30},
                       {"nearest", 0, Learner::kNearest, 0, "too many"}};
  choice.contacts = 36;
  choice.folds = 3;
  choice.by = FoldsBy::kGroups;
  choice.chance = 0.25;
  const PresetChoice back = FromProto(ToProto(choice));
  EXPECT_EQ(back.name, "ridge");
  EXPECT_EQ(back.options.learner, Learner::kRidge);
  ASSERT_EQ(back.candidates.size(), 3u);
  EXPECT_EQ(back.candidates[2].learner, Learner::kNearest);
  EXPECT_EQ(back.candidates[2].unfit, "too many");
  EXPECT_EQ(back.candidates[1].right, 30);
  EXPECT_EQ(back.by, FoldsBy::kGroups);
  EXPECT_EQ(back.chance, 0.25);
}

// Classes that only the order of the load tells apart: an LSTM learns it, and
// an HMM of one state cannot.
std::vector<LabelledContact> OrderContacts() {
  std::vector<LabelledContact> contacts;
  Random random(3);
  for (int i = 0; i < 48; ++i) {
    LabelledContact contact;
    contact.id = std::to_string(i);
    contact.label = i % 2 == 0 ? "up" : "down";
    contact.material = "m" + std::to_string(i / 2 % 4);
    for (int t = 0; t < 20; ++t) {
      const bool high = (t < 10) == (i % 2 == 0);
      contact.frames.push_back({IdealSample(
          {(high ? 2 : 1) + 0.1 * random.Gaussian(), 1e-4, 1e-3})});
    }
    contacts.push_back(std::move(contact));
  }
  return contacts;
}

ChoiceRequest OrderRequest() {
  FitOptions options = HmmOf({Cue::kForce});
  options.states = 1;
  options.lstm.cells = {8};
  options.lstm.training.epochs = 30;
  options.lstm.training.optimizer.optimizer = Optimizer::kAdam;
  options.lstm.training.optimizer.learning_rate = 0.02;
  return {.presets = {{"order", options}}};
}

TEST(AutoPresetTest, LstmsAreComparedAndChosenWhereTheyAreBetter) {
  const auto contacts = OrderContacts();
  const auto choice =
      ChoosePreset(PointersTo(contacts), OrderRequest(), RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  ASSERT_EQ(choice->candidates.size(), 2u);
  EXPECT_LT(choice->candidates[0].right, 36);
  EXPECT_GT(choice->candidates[1].right, 43);
  EXPECT_EQ(choice->options.lstm.networks, 1);
  // Again, and with the folds on other threads: the same.
  const auto again =
      ChoosePreset(PointersTo(contacts), OrderRequest(), RunSerially);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->candidates[1].right, choice->candidates[1].right);
  EXPECT_EQ(again->work, choice->work);
}

TEST(AutoPresetTest, TheLimitOnWorkLeavesLstmsOut) {
  const auto contacts = OrderContacts();
  ChoiceRequest request = OrderRequest();
  request.work_limit = 0;
  const auto choice = ChoosePreset(PointersTo(contacts), request, RunSerially);
  ASSERT_TRUE(choice.ok()) << choice.status();
  EXPECT_EQ(choice->options.lstm.networks, 0);
  EXPECT_EQ(choice->work, 0);
  EXPECT_NE(choice->candidates[1].unfit.find("the limit is 0"),
            std::string::npos);
}

TEST(AutoPresetTest, AGivenNumberOfLstmsIsKept) {
  const auto contacts = OrderContacts();
  ChoiceRequest request = OrderRequest();
  request.networks_given = true;
  for (const int networks : {0, 2}) {
    request.presets[0].second.lstm.networks = networks;
    for (const int limit : {0, 1000}) {
      request.work_limit = limit;
      const auto choice =
          ChoosePreset(PointersTo(contacts), request, RunSerially);
      ASSERT_TRUE(choice.ok()) << choice.status();
      EXPECT_EQ(choice->options.lstm.networks, networks);
    }
  }
}

TEST(AutoPresetTest, TooFewContactsAreRefused) {
  const auto contacts = ForceContacts(2);
  EXPECT_EQ(ReasonOf(ChoosePreset(PointersTo(contacts),
                                  Hmms({{"force", HmmOf({Cue::kForce})}}),
                                  RunSerially)
                         .status()),
            "INVALID_TRAINING_DATA");
  EXPECT_EQ(ReasonOf(ChoosePreset({}, {}, RunSerially).status()),
            "INVALID_TRAINING_DATA");
}

// Also where a candidate that cannot be fitted would be left out.
TEST(AutoPresetTest, ItCanBeCancelledAtAnyQuestion) {
  const auto contacts = ForceContacts(6);
  int questions = 0;
  int cancel_at = 0;
  ChoiceRequest request = {
      .presets = {{"force", HmmOf({Cue::kForce})},
                  {"motion", HmmOf({Cue::kMotion})}},
      .cancelled = [&] { return ++questions == cancel_at; }};
  const auto whole = ChoosePreset(PointersTo(contacts), request, RunSerially);
  ASSERT_TRUE(whole.ok()) << whole.status();
  const int all = questions;
  ASSERT_GT(all, 100);
  for (cancel_at = 1; cancel_at <= all; cancel_at += all / 20) {
    questions = 0;
    const auto cancelled =
        ChoosePreset(PointersTo(contacts), request, RunSerially);
    ASSERT_EQ(ReasonOf(cancelled.status()), "CANCELLED") << cancel_at;
  }
  request.cancelled = nullptr;
  const auto unasked = ChoosePreset(PointersTo(contacts), request, RunSerially);
  ASSERT_TRUE(unasked.ok()) << unasked.status();
  EXPECT_EQ(unasked->name, whole->name);
  EXPECT_EQ(unasked->candidates.size(), whole->candidates.size());
}

// The multiplications of a small network, counted by hand.
TEST(AutoPresetTest, TheWorkIsThatOfTheLoops) {
  const auto contacts = OrderContacts();
  FitOptions options = HmmOf({Cue::kForce});
  options.lstm.networks = 2;
  options.lstm.cells = {3, 5};
  options.lstm.training.epochs = 7;
  options.variations.copies = 1;
  double steps = 0;
  for (const LabelledContact& contact : contacts) {
    steps += static_cast<double>(CountSteps(contact, options.lstm.steps));
  }
  // 4 gates x cells x (inputs + cells) of both layers, and 2 classes.
  const double weights = 4 * 3 * (1 + 3) + 4 * 5 * (3 + 5) + 2 * 5;
  EXPECT_EQ(LstmWork(PointersTo(contacts), options),
            3 * weights * steps * 2 * 7 * 2);
}

}  // namespace
}  // namespace tactus::internal
