// Training as a request describes it: what it changes of a preset, and what is
// refused.
#include "core/train/train_spec.h"

#include <algorithm>
#include <functional>
#include <string>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

FitOptions Options(const v1::TrainSpec& spec, absl::string_view preset) {
  auto options = OptionsOf(spec, preset);
  EXPECT_TRUE(options.ok()) << options.status();
  return *std::move(options);
}

TEST(TrainSpecTest, AnEmptySpecIsThePreset) {
  for (const char* preset : {"paper", "tuned", "world", "whole-skin"}) {
    const FitOptions options = Options({}, preset);
    const FitOptions plain = *FitPreset(preset);
    EXPECT_EQ(options.truth, plain.truth) << preset;
    EXPECT_EQ(options.shares, plain.shares) << preset;
    EXPECT_EQ(options.hmm_cues, plain.hmm_cues) << preset;
    EXPECT_EQ(options.lstm.cues, plain.lstm.cues) << preset;
    EXPECT_EQ(options.lstm.stretched_cues, plain.lstm.stretched_cues) << preset;
    EXPECT_EQ(options.seed, plain.seed) << preset;
  }
}

TEST(TrainSpecTest, BothTruthsCanBeAskedForWithAnyPreset) {
  v1::TrainSpec spec;
  for (const char* preset : {"tuned", "world"}) {
    spec.set_truth(v1::TRUTH_SO_FAR);
    EXPECT_EQ(Options(spec, preset).truth, Truth::kSoFar) << preset;
    spec.set_truth(v1::TRUTH_FINAL);
    EXPECT_EQ(Options(spec, preset).truth, Truth::kFinal) << preset;
  }
}

TEST(TrainSpecTest, SharesCanBeEven) {
  v1::TrainSpec spec;
  spec.set_shares(v1::CLASS_SHARES_EVEN);
  EXPECT_EQ(Options(spec, "world").shares, ClassShares::kEven);
  spec.set_shares(v1::CLASS_SHARES_RECORDED);
  EXPECT_EQ(Options(spec, "world").shares, ClassShares::kRecorded);
}

TEST(TrainSpecTest, QuestionsAreALabelTable) {
  EXPECT_TRUE(Options({}, "world").questions.class_names.empty());
  v1::TrainSpec spec;
  spec.set_questions("class,loose:state\nHU,no\nHM,yes\n");
  const FitOptions options = Options(spec, "world");
  ASSERT_EQ(options.questions.questions.size(), 1u);
  EXPECT_EQ(options.questions.questions[0].kind, Question::kState);
  spec.set_questions("class,loose:maybe\nHU,no\nHM,yes\n");
  EXPECT_EQ(ReasonOf(CheckOptions(spec)), "INVALID_CONFIG");
}

TEST(TrainSpecTest, CuesAreAddedAndLeftOut) {
  v1::TrainSpec spec;
  spec.add_with_cues("force_pitch_short");
  spec.add_without_cues("log_drag");
  const FitOptions plain = *FitPreset("world");
  const Cue added = *ParseCue("force_pitch_short");
  const Cue removed = *ParseCue("log_drag");
  ASSERT_THAT(plain.lstm.cues, Not(Contains(added)));
  ASSERT_TRUE(std::ranges::count(plain.lstm.cues, removed) +
                  std::ranges::count(plain.lstm.stretched_cues, removed) >
              0);
  const FitOptions options = Options(spec, "world");
  EXPECT_THAT(options.lstm.cues, Contains(added));
  for (const auto& cues :
       {options.hmm_cues, options.lstm.cues, options.lstm.stretched_cues}) {
    EXPECT_THAT(cues, Not(Contains(removed)));
  }
}

TEST(TrainSpecTest, WhatCannotBeDoneIsRefusedBeforeTheWork) {
  struct Case {
    std::function<void(v1::TrainSpec&)> change;
    const char* why;
  };
  const Case cases[] = {
      {[](auto& s) { s.set_preset("magic"); }, "magic"},
      {[](auto& s) { s.set_truth(static_cast<v1::Truth>(7)); }, "truth is 7"},
      {[](auto& s) { s.set_shares(static_cast<v1::ClassShares>(7)); },
       "shares is 7"},
      {[](auto& s) { s.add_with_cues("smell"); }, "with_cues is smell"},
      {[](auto& s) { s.add_with_cues(""); }, "with_cues is"},
      {[](auto& s) {
         s.add_with_cues("force_pitch_short");
         s.add_with_cues("force_pitch_short");
       },
       "would not take already"},
      {[](auto& s) {
         s.set_networks(0);
         s.add_with_cues("force_pitch_short");
       },
       "empty without LSTMs"},
      {[](auto& s) { s.add_without_cues("smell"); }, "without_cues is smell"},
      {[](auto& s) { s.add_without_cues("force_pitch_short"); },
       "that the models would take"},
      // Which models would take the cue is not known before the choice.
      {[](auto& s) {
         s.set_preset("auto");
         s.add_with_cues("force_pitch_short");
       },
       "preset is auto"},
      {[](auto& s) {
         s.clear_preset();
         s.add_without_cues("log_drag");
       },
       "preset is auto"},
  };
  for (const Case& c : cases) {
    v1::TrainSpec spec;
    spec.set_preset("world");
    c.change(spec);
    const absl::Status status = CheckOptions(spec);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << spec.DebugString();
    EXPECT_THAT(std::string(status.message()), HasSubstr(c.why));
  }
}

}  // namespace
}  // namespace tactus::internal
