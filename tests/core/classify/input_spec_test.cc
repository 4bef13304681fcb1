#include "core/classify/input_spec.h"

#include <cmath>
#include <utility>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

TEST(MakeInputTest, TransformsThenScalesInTheOrderOfTheSpec) {
  const ModelInput inputs[] = {{Cue::kMotion, 0, 1, 10},
                               {Cue::kForce, 0.5, 0, 2}};
  CueTracker cues(100);
  cues.Step({{2.0, 9.0, 3.0}, 2.0}, 1);  // force, area, motion
  double out[2];
  MakeInput(inputs, cues, out);
  EXPECT_DOUBLE_EQ(out[0], 20);
  EXPECT_DOUBLE_EQ(out[1], 2 * std::log(2.5));
}

TEST(MakeInputTest, InputsAreHeldWithinTheirLimits) {
  const ModelInput inputs[] = {{.cue = Cue::kForce, .limit = 5},
                               {.cue = Cue::kArea, .limit = 1},
                               {.cue = Cue::kForce}};
  CueTracker cues(100);
  cues.Step({{1e9, -1e9, 0}, 1e9}, 1);
  double out[3];
  MakeInput(inputs, cues, out);
  EXPECT_EQ(out[0], 5);
  EXPECT_EQ(out[1], -1);
  EXPECT_EQ(out[2], 1e9);
}

TEST(MakeInputTest, NegativeNoiseIsClampedBeforeTheLogarithm) {
  EXPECT_DOUBLE_EQ(TransformCue(-3, 0.01), std::log(0.01));
}

TEST(FeaturesUsedTest, NamesWhatTheCuesAreComputedFrom) {
  InputSpec spec;
  spec.hmm = {{NamedCue("log_time")}, {NamedCue("log_area")}};
  EXPECT_EQ(FeaturesUsed(spec), std::vector<Feature>{Feature::kArea});
  spec.lstm = {{NamedCue("log_spring")}};
  EXPECT_EQ(FeaturesUsed(spec).size(), 3u);
}

TEST(UsesProfileTest, LooksAtBothModels) {
  InputSpec spec;
  spec.hmm = {{NamedCue("log_area")}};
  EXPECT_FALSE(UsesProfile(spec));
  spec.lstm = {{NamedCue("row_load_0")}};
  EXPECT_TRUE(UsesProfile(spec));
  std::swap(spec.hmm, spec.lstm);
  EXPECT_TRUE(UsesProfile(spec));
}

TEST(ValidateInputSpecTest, EachSpoiltFieldIsRefused) {
  const InputSpec good = testing::SmallModel().inputs;
  EXPECT_TRUE(Validate(good, true, false).ok());
  // A ridge stands in place of HMMs.
  EXPECT_FALSE(Validate(good, false, false).ok());
  InputSpec of_ridge = good;
  of_ridge.hmm.clear();
  EXPECT_TRUE(Validate(of_ridge, false, false).ok());
  using Spoil = void (*)(InputSpec&);
  const Spoil spoils[] = {
      [](InputSpec& s) { s.hmm.clear(); },
      [](InputSpec& s) { s.hmm[1].limit = 0; },
      [](InputSpec& s) { s.hmm[0].log_offset = -1; },
      [](InputSpec& s) { s.hmm[0].gain = 0; },
      [](InputSpec& s) { s.hmm[0].offset = std::nan(""); },
      [](InputSpec& s) { s.lstm = s.hmm; },
      [](InputSpec& s) { s.lstm_steps.min = 0; },
      [](InputSpec& s) { s.hmm_steps.min = 0; },
      [](InputSpec& s) { s.lstm_steps.first = s.lstm_steps.min + 1; },
      [](InputSpec& s) { s.hmm_steps.divisor = 1; },
      [](InputSpec& s) { s.hmm_steps.divisor = 0; },
      [](InputSpec& s) {
        s.lstm_steps = {5, 4};
      },
      [](InputSpec& s) { s.sample_rate_hz = 0; },
  };
  for (size_t i = 0; i < std::size(spoils); ++i) {
    InputSpec spec = good;
    spoils[i](spec);
    EXPECT_EQ(ReasonOf(Validate(spec, true, false)), "INVALID_MODEL") << i;
  }
}

}  // namespace
}  // namespace tactus::internal
