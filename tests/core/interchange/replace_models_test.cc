#include "core/interchange/replace_models.h"

#include "core/base/errors.h"
#include "core/classify/compiled_model.h"
#include "core/classify/warm_up.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

Model WithLstms() {
  Model model = testing::SmallModel();
  testing::AddLstms(2, model);
  return model;
}

LstmNetwork Network(uint64_t seed) {
  return MakeNetwork(2, {4}, 4, Activation::kTanh, GateActivation::kSigmoid,
                     seed);
}

void ExpectRefused(const ForeignModel& foreign, Model model, const char* text) {
  const std::vector<LstmNetwork> lstms = model.lstms;
  const absl::Status status = ReplaceModels(foreign, model);
  EXPECT_EQ(ReasonOf(status), "INVALID_MODEL");
  EXPECT_THAT(std::string(status.message()), HasSubstr(text));
  EXPECT_EQ(model.lstms.size(), lstms.size());
}

TEST(ReplaceModelsTest, HmmsOfNamedClassesAreReplaced) {
  Model model = testing::SmallModel();
  ForeignModel foreign;
  foreign.hmms = {{"SU", model.hmms[0]}};
  foreign.hmms[0].mixture.components[0].means[0] = 42;
  foreign.hmm_score = Score::kViterbi;
  ASSERT_TRUE(ReplaceModels(foreign, model).ok());
  EXPECT_EQ(model.hmms[2].components[0].means[0], 42);
  EXPECT_EQ(model.hmms[0].components[0].means[0], 0);
  EXPECT_EQ(model.hmm_score, Score::kViterbi);
}

TEST(ReplaceModelsTest, OutputsFollowTheModelsOrderOfClasses) {
  Model model = WithLstms();
  ForeignModel foreign;
  foreign.lstms = {Network(5)};
  foreign.class_names = {"SM", "HU", "SU", "HM"};
  ASSERT_TRUE(ReplaceModels(foreign, model).ok());
  ASSERT_EQ(model.lstms.size(), 1u);
  const Rows inputs = MakeInputs(2, 10, 6);
  const Rows ours = Posteriors(model.lstms, inputs);
  const Rows theirs = Posteriors(foreign.lstms, inputs);
  for (size_t t = 0; t < ours.size(); ++t) {
    // The softmax adds up in another order.
    EXPECT_NEAR(ours[t][0], theirs[t][1], 1e-12);
    EXPECT_NEAR(ours[t][1], theirs[t][3], 1e-12);
    EXPECT_NEAR(ours[t][2], theirs[t][2], 1e-12);
    EXPECT_NEAR(ours[t][3], theirs[t][0], 1e-12);
  }
}

TEST(ReplaceModelsTest, AModelWithoutNetworksGetsThem) {
  Model model = testing::SmallModel();
  ForeignModel foreign;
  foreign.lstms = {Network(5)};
  ExpectRefused(foreign, model, "inputs of the network is not stated");
  foreign.inputs = {{Cue::kForce}, {Cue::kMotion, 0, 0, 3}};
  foreign.steps = StepIntervals{5, 20};
  ASSERT_TRUE(ReplaceModels(foreign, model).ok());
  EXPECT_EQ(model.inputs.lstm[1].gain, 3);
  EXPECT_EQ(model.inputs.lstm_steps.max, 20u);
  EXPECT_EQ(model.calibration.lstm_weight, (std::vector<double>{0.5, 0.5}));
  model.warm_up.samples = {{{1, 2, 3}, 4}, {{5, 6, 7}, 8}};
  ASSERT_TRUE(AnswerWarmUp(model).ok());
  EXPECT_TRUE(RunWarmUp(**CompiledModel::Create(model)).ok());
}

TEST(ReplaceModelsTest, AnEstimatorGoesIfItsInputsOrStepsChange) {
  const Model estimating = [] {
    Model model = WithLstms();
    model.estimator =
        RandomNetwork(2, {3}, 4, Activation::kTanh, GateActivation::kSigmoid, 5,
                      /*forget_bias=*/1, /*regressions=*/2);
    model.calibration.softest = {2, 3};
    return model;
  }();
  ForeignModel same;
  same.lstms = {Network(5)};
  same.inputs = estimating.inputs.lstm;
  same.steps = estimating.inputs.lstm_steps;
  Model model = estimating;
  ASSERT_TRUE(ReplaceModels(same, model).ok());
  EXPECT_TRUE(model.estimator.has_value());
  EXPECT_EQ(model.calibration.softest, estimating.calibration.softest);

  ForeignModel other_inputs = same;
  other_inputs.inputs[0].offset += 1;
  ForeignModel other_steps = same;
  other_steps.steps->max += 20;
  for (const ForeignModel& other : {other_inputs, other_steps}) {
    model = estimating;
    const absl::Status status = ReplaceModels(other, model);
    ASSERT_TRUE(status.ok()) << status;
    EXPECT_FALSE(model.estimator.has_value());
    // What the estimates were compared with goes too.
    EXPECT_TRUE(model.calibration.softest.empty());
  }
}

TEST(ReplaceModelsTest, WhatDoesNotFitIsRefused) {
  const Model model = WithLstms();
  ForeignModel hmms;
  hmms.hmms = {{"glass", model.hmms[0]}};
  ExpectRefused(hmms, model, "class is glass; it must be one of HU, HM");
  hmms.hmms[0].class_name = "";
  ExpectRefused(hmms, model, "class is not named");
  hmms.hmms = {{"HU", model.hmms[0]}, {"HU", model.hmms[0]}};
  ExpectRefused(hmms, model, "class is HU; it must be there once");
  // The other classes' HMMs would get inputs that they were not made for.
  hmms.hmms = {{"HU", model.hmms[0]}};
  hmms.inputs = {{Cue::kForce}, {Cue::kArea}};
  ExpectRefused(hmms, model, "HMMs of all classes");
  hmms.inputs = {};
  hmms.hmms[0].mixture = HmmSample().hmms[0];
  ExpectRefused(hmms, model, "HMM dimensions is 3");
  hmms.hmms[0].mixture = model.hmms[0];
  hmms.sample_rate_hz = 50;
  ExpectRefused(hmms, model, "sample_rate_hz is 50");

  ForeignModel lstms;
  lstms.lstms = {
      MakeNetwork(3, {4}, 4, Activation::kTanh, GateActivation::kSigmoid, 5)};
  ExpectRefused(lstms, model, "LSTM inputs");
  lstms.lstms = {Network(5)};
  lstms.class_names = {"HU", "HM", "SU", "SU"};
  ExpectRefused(lstms, model, "classes of the network");
  lstms.class_names = {"HU", "HM", "SU", "glass"};
  ExpectRefused(lstms, model, "class is glass");
}

}  // namespace
}  // namespace tactus::internal
