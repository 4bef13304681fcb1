#include "core/bundle/bundle.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/bundle/model_proto.h"
#include "gmock/gmock.h"
#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

Model FullModel() {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset("cody-forearm");
  model.layout.mask.assign(model.layout.taxels(), 1);
  model.layout.mask[7] = 0;
  model.release_after_s = -1;
  model.hmm_score = Score::kViterbi;
  for (uint64_t seed : {3, 4}) {
    model.lstms.push_back(RandomNetwork(3, {5, 3}, 4, Activation::kSoftsign,
                                        GateActivation::kHardSigmoid, seed,
                                        /*forget_bias=*/1));
  }
  model.estimator = RandomNetwork(3, {5, 3}, 4, Activation::kSoftsign,
                                  GateActivation::kHardSigmoid, 5,
                                  /*forget_bias=*/1, /*regressions=*/2);
  model.calibration.stiffness_deviation_scale = 1.5;
  model.calibration.softest = {2, 3};
  model.inputs.lstm = {{NamedCue("log_spring"), 0, 1, 2},
                       {Cue::kArea, 0.5, 3, 4},
                       {NamedCue("log_time")}};
  model.inputs.lstm_steps = {.min = 5, .max = 20, .first = 2, .divisor = 8};
  model.inputs.hmm_steps = {.min = 4, .max = 30, .first = 3, .divisor = 9};
  testing::AddLstmCalibration(model.calibration);
  model.calibration.lstm_weight = {0.25, 0.5};
  model.calibration.lstm_inverse_temperature = {1, 0.75};
  model.calibration.hmm_weight = {0.75, 0.125};
  model.calibration.fused_bias[5] = -0.5;
  model.calibration.held = true;
  model.questions = DefaultQuestions(model.class_names);
  model.questions[0].name = "härte";
  model.calibration.question_threshold = {0.97, 0.99};
  model.calibration.question_frames = {4, 10'000};
  model.truth = Truth::kSoFar;
  model.poses = PoseNeed::kNeeded;
  model.more_layouts = {model.layout};
  model.more_layouts[0].onset_threshold *= 2;
  model.provenance = {"command", "0.1.0", 12,        34,
                      "data.h5", "note",  {1, ~0UL}, std::string(64, 'a')};
  model.warm_up.samples = {{{1, 2, 3}, 4}, {{5, 6, 7}, 8}};
  model.warm_up.probability = {0.1, 0.2, 0.3, 0.4};
  model.warm_up.log_likelihood = {-1, -2, -3, -4};
  return model;
}

// Bundles of earlier releases say neither where the first step is nor how the
// intervals grow.
TEST(BundleTest, WithoutAFirstStepItIsAtMinAndIntervalsAreATenth) {
  v1::ModelBundle bundle = ModelToProto(FullModel());
  v1::InputSpec& inputs = *bundle.mutable_inputs();
  inputs.clear_lstm_first_step();
  inputs.clear_lstm_interval_divisor();
  inputs.clear_hmm_first_step();
  inputs.clear_hmm_interval_divisor();
  const auto back = ModelFromProto(bundle);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->inputs.lstm_steps, (StepIntervals{5, 20, 0, 10}));
  EXPECT_EQ(back->inputs.hmm_steps, (StepIntervals{4, 30, 0, 10}));
}

// Bundles of earlier releases say nothing of it.
TEST(BundleTest, WithoutAReleaseItIsHalfASecond) {
  v1::ModelBundle bundle = ModelToProto(FullModel());
  bundle.clear_release_after_s();
  EXPECT_EQ(ModelFromProto(bundle)->release_after_s, 0.5);
  for (const double bad : {60.1, std::nan(""), 1.0 / 0.0}) {
    Model model = FullModel();
    model.release_after_s = bad;
    EXPECT_EQ(ReasonOf(EncodeBundle(model).status()), "INVALID_MODEL") << bad;
  }
}

// Readers of version 1 would leave the hidden layers out without a word.
TEST(BundleTest, HiddenLayersGoThroughABundleOfVersion2) {
  Model model = FullModel();
  EXPECT_EQ((*EncodeBundle(model))[8], 1);
  for (LstmNetwork& network : model.lstms) {
    network.hidden = {
        {3, 2, HiddenActivation::kRelu, {1, 2, 3, 4, 5, 6}, {-1, 1}},
        {2, 3, HiddenActivation::kSigmoid, {6, 5, 4, 3, 2, 1}, {0, 1, 2}}};
  }
  const auto bytes = EncodeBundle(model);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_EQ((*bytes)[8], 2);
  const auto back = DecodeBundle(*bytes);
  ASSERT_TRUE(back.ok()) << back.status();
  const LstmNetwork& network = (*back)->model().lstms[1];
  ASSERT_EQ(network.hidden.size(), 2u);
  EXPECT_EQ(network.hidden[0].activation, HiddenActivation::kRelu);
  EXPECT_EQ(network.hidden[0].kernel, model.lstms[1].hidden[0].kernel);
  EXPECT_EQ(network.hidden[1].activation, HiddenActivation::kSigmoid);
  EXPECT_EQ(network.hidden[1].bias, model.lstms[1].hidden[1].bias);
}

TEST(BundleTest, ASoftestObjectNeedsAnEstimator) {
  Model model = FullModel();
  model.estimator.reset();
  const absl::Status status = EncodeBundle(model).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_MODEL");
  EXPECT_THAT(std::string(status.message()),
              ::testing::HasSubstr("calibration.softest size is 2"));
}

// They pooled log-probabilities with weights that sum to 1 and without biases.
TEST(BundleTest, CalibrationsOfEarlierReleasesAreFilledIn) {
  v1::ModelBundle bundle = ModelToProto(FullModel());
  v1::Calibration& calibration = *bundle.mutable_calibration();
  calibration.clear_hmm_weight();
  calibration.clear_hmm_bias();
  calibration.clear_lstm_bias();
  calibration.clear_fused_bias();
  calibration.clear_held();
  calibration.clear_softest();
  bundle.clear_truth();
  bundle.clear_poses();
  const auto model = ModelFromProto(bundle);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->calibration.hmm_weight, (std::vector<double>{0.75, 0.5}));
  EXPECT_EQ(model->calibration.fused_bias, std::vector<double>(8, 0));
  EXPECT_FALSE(model->calibration.held);
  EXPECT_TRUE(model->calibration.softest.empty());
  EXPECT_EQ(model->truth, Truth::kFinal);
  EXPECT_EQ(model->poses, PoseNeed::kEither);
  EXPECT_TRUE(Validate(*model).ok()) << Validate(*model);
}

TEST(BundleTest, BundlesOfEarlierReleasesAnswerTheDefaultQuestions) {
  v1::ModelBundle bundle = ModelToProto(FullModel());
  bundle.clear_questions();
  bundle.mutable_calibration()->clear_question_threshold();
  bundle.mutable_calibration()->clear_question_frames();
  const auto model = ModelFromProto(bundle);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_TRUE(model->questions.empty());
  const auto compiled = CompiledModel::Create(*model);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  ASSERT_EQ((*compiled)->questions().size(), 2u);
  EXPECT_EQ((*compiled)->questions()[0].name, "hardness");
  EXPECT_EQ((*compiled)->questions()[1].name, "mobility");
  for (const DecisionRule& rule : (*compiled)->rules()) {
    EXPECT_EQ(rule.threshold, 0.8);
    EXPECT_EQ(rule.frames, 5u);
  }
  // Kept as it is, its bytes stay the same.
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
      ModelToProto((*compiled)->model()), bundle));
}

TEST(BundleTest, QuestionsMustFitTheClasses) {
  const auto refused = [](auto change, const char* text) {
    v1::ModelBundle bundle = ModelToProto(FullModel());
    change(bundle);
    auto model = ModelFromProto(bundle);
    const absl::Status status = model.ok() ? Validate(*model) : model.status();
    EXPECT_EQ(ReasonOf(status), "INVALID_MODEL") << text;
    EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr(text));
  };
  using Bundle = v1::ModelBundle;
  refused([](Bundle& b) { b.mutable_questions(0)->set_value_of_class(2, 2); },
          "below 2");
  refused([](Bundle& b) { b.mutable_questions(0)->set_value_of_class(2, ~0U); },
          "below 2");
  refused([](Bundle& b) { b.mutable_questions(1)->clear_kind(); },
          "question kind");
  refused([](Bundle& b) { b.clear_questions(); },
          "question_threshold and question_frames");
  refused([](Bundle& b) { b.mutable_calibration()->clear_question_frames(); },
          "question_threshold and question_frames");
  refused(
      [](Bundle& b) {
        b.mutable_calibration()->set_question_threshold(0, 0.5);
      },
      "calibration.question_threshold");
  refused([](Bundle& b) { b.mutable_calibration()->set_question_frames(0, 0); },
          "calibration.question_frames");
}

TEST(BundleTest, RoundTripKeepsEveryField) {
  const Model model = FullModel();
  auto bytes = EncodeBundle(model);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const auto compiled = DecodeBundle(*bytes);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  const Model* back = &(*compiled)->model();
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
      ModelToProto(model), ModelToProto(*back)));
  EXPECT_EQ(back->layout.mask, model.layout.mask);
  EXPECT_EQ(back->release_after_s, -1);
  EXPECT_EQ(back->hmm_score, Score::kViterbi);
  EXPECT_EQ(back->truth, Truth::kSoFar);
  ASSERT_EQ(back->questions.size(), 2u);
  EXPECT_EQ(back->questions[0].name, "härte");
  EXPECT_EQ(back->questions[0].kind, Question::kProperty);
  EXPECT_EQ(back->questions[1].kind, Question::kState);
  EXPECT_EQ(back->questions[1].values, model.questions[1].values);
  EXPECT_EQ(back->questions[1].value_of_class,
            model.questions[1].value_of_class);
  EXPECT_EQ((*compiled)->rules()[1].threshold, 0.99);
  EXPECT_EQ((*compiled)->rules()[1].frames, 10'000u);
  EXPECT_EQ(back->poses, PoseNeed::kNeeded);
  EXPECT_EQ(back->more_layouts, model.more_layouts);
  EXPECT_EQ(back->calibration.hmm_weight, model.calibration.hmm_weight);
  EXPECT_EQ(back->calibration.fused_bias, model.calibration.fused_bias);
  EXPECT_TRUE(back->calibration.held);
  ASSERT_EQ(back->lstms.size(), 2u);
  EXPECT_EQ(back->lstms[1].layers[1].recurrent,
            model.lstms[1].layers[1].recurrent);
  EXPECT_EQ(back->estimator->regressions, 2);
  EXPECT_EQ(back->calibration.stiffness_deviation_scale, 1.5);
  EXPECT_EQ(back->calibration.softest, (std::vector<double>{2, 3}));
  EXPECT_EQ(back->lstms[0].classes(), 4);
  EXPECT_EQ(back->inputs.lstm[1].cue, Cue::kArea);
  EXPECT_EQ(back->inputs.lstm_steps, model.inputs.lstm_steps);
  EXPECT_EQ(back->inputs.hmm_steps, model.inputs.hmm_steps);
  EXPECT_EQ(back->warm_up.samples[1].features, (FeatureVector{5, 6, 7}));
  EXPECT_EQ(back->warm_up.samples[1].net_force, 8);
}

TEST(BundleTest, TheLoadProfileOfTheWarmUpIsKeptIfTheModelSeesIt) {
  Model model = FullModel();
  model.warm_up.samples[1].profile[15] = 7;
  v1::ModelBundle without = ModelToProto(model);
  EXPECT_EQ(without.warm_up().profile_size(), 0);
  model.inputs.lstm[2].cue = NamedCue("column_load_9");
  v1::ModelBundle bundle = ModelToProto(model);
  auto back = ModelFromProto(bundle);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->warm_up.samples[0].profile, LoadProfile{});
  EXPECT_EQ(back->warm_up.samples[1].profile, model.warm_up.samples[1].profile);

  bundle.mutable_warm_up()->mutable_profile()->RemoveLast();
  EXPECT_EQ(ReasonOf(ModelFromProto(bundle).status()), "INVALID_MODEL");
  without.mutable_warm_up()->add_profile(1);
  EXPECT_EQ(ReasonOf(ModelFromProto(without).status()), "INVALID_MODEL");
}

TEST(BundleTest, TheSameModelGivesTheSameBytes) {
  EXPECT_EQ(*EncodeBundle(FullModel()), *EncodeBundle(FullModel()));
}

TEST(BundleTest, EveryFlippedByteIsRefused) {
  const std::string good = *EncodeBundle(FullModel());
  for (size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    const auto model = DecodeBundle(bad);
    ASSERT_FALSE(model.ok()) << "byte " << i;
    EXPECT_EQ(model.status().code(), absl::StatusCode::kDataLoss);
    EXPECT_EQ(ReasonOf(model.status()), "BUNDLE_CORRUPT");
  }
}

TEST(BundleTest, EveryTruncationAndExtensionIsRefused) {
  const std::string good = *EncodeBundle(FullModel());
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_EQ(ReasonOf(DecodeBundle(good.substr(0, length)).status()),
              "BUNDLE_CORRUPT")
        << length;
  }
  EXPECT_EQ(ReasonOf(DecodeBundle(good + '\0').status()), "BUNDLE_CORRUPT");
}

TEST(BundleTest, TheIdIsTheChecksumInHexadecimal) {
  const std::string bytes = *EncodeBundle(FullModel());
  EXPECT_EQ(BundleSha256(bytes).size(), 64u);
  EXPECT_EQ(BundleSha256("short"), "");
}

TEST(BundleTest, AnInvalidModelIsNotEncoded) {
  Model model = FullModel();
  model.hmms.pop_back();
  EXPECT_EQ(ReasonOf(EncodeBundle(model).status()), "INVALID_MODEL");
}

TEST(ModelFromProtoTest, UnknownEnumeratorsAndNamesAreRefused) {
  const v1::ModelBundle good = ModelToProto(FullModel());
  using Spoil = void (*)(v1::ModelBundle&);
  const Spoil spoils[] = {
      [](v1::ModelBundle& b) { b.clear_hmm_score(); },
      [](v1::ModelBundle& b) { b.mutable_inputs()->set_hmm_cues(0, "smell"); },
      [](v1::ModelBundle& b) { b.mutable_lstm(0)->clear_activation(); },
      [](v1::ModelBundle& b) { b.mutable_warm_up()->add_signals(1); },
      [](v1::ModelBundle& b) {
        b.mutable_hmms(0)->mutable_components(0)->clear_covariance_type();
      },
  };
  for (size_t i = 0; i < std::size(spoils); ++i) {
    v1::ModelBundle bundle = good;
    spoils[i](bundle);
    EXPECT_FALSE(ModelFromProto(bundle).ok()) << i;
  }
}

}  // namespace
}  // namespace tactus::internal
