#include "core/classify/contact_classifier.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/random.h"
#include "core/classify/calibration.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

std::shared_ptr<const CompiledModel> SmallCompiled() {
  return *CompiledModel::Create(testing::SmallModel());
}

double Sum(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// A contact like class HU's second state: force e, no motion.
constexpr ContactSample kHard = {{2.71, 0, 0}, 2.71};
// One like SM's: little force, 15 mm.
constexpr ContactSample kSoftMoved = {{0.125, 0, 0.015}, 0.125};

TEST(ContactClassifierTest, StartsAtThePrior) {
  ContactClassifier classifier(SmallCompiled(), {});
  for (double p : classifier.probability()) EXPECT_DOUBLE_EQ(p, 0.25);
  EXPECT_EQ(classifier.unknown(), 0);
  EXPECT_FALSE(classifier.decision());
  EXPECT_EQ(classifier.stability(), 0);
}

// Brute force over all state paths of a two-state model, in long double.
TEST(ContactClassifierTest, LogLikelihoodIsTheSumOverAllPaths) {
  const Model model = testing::SmallModel();
  ContactClassifier classifier(SmallCompiled(), {});
  Random random(5);
  std::vector<FeatureVector> frames(8);
  for (auto& frame : frames) {
    frame = {random.Uniform(0, 4), 0, random.Uniform(0, 0.02)};
    classifier.Step({frame, frame[0]}, 0);
  }
  for (int k = 0; k < 4; ++k) {
    const GaussianHmm& hmm = model.hmms[k].components[0];
    long double total = 0;
    for (int path = 0; path < 256; ++path) {
      long double p = 1;
      int previous = -1;
      for (int t = 0; t < 8; ++t) {
        const int state = path >> t & 1;
        p *= previous < 0 ? hmm.start[state]
                          : hmm.transition[previous * 2 + state];
        const long double x[] = {std::log(frames[t][0] + 0.01L),
                                 frames[t][2] * 100.0L};
        for (int d = 0; d < 2; ++d) {
          const long double variance = hmm.covariances[state * 2 + d];
          const long double z = x[d] - hmm.means[state * 2 + d];
          p *= std::exp(-z * z / (2 * variance)) /
               std::sqrt(2 * 3.14159265358979323846L * variance);
        }
        previous = state;
      }
      total += p;
    }
    const double want = static_cast<double>(std::log(total));
    EXPECT_NEAR(classifier.log_likelihood()[k], want, 1e-6 * std::abs(want));
  }
}

TEST(ContactClassifierTest, FollowsTheEvidence) {
  ContactClassifier classifier(SmallCompiled(), {});
  for (int t = 0; t < 50; ++t) classifier.Step(kHard, 0);
  EXPECT_EQ(classifier.best_class(), 0);
  classifier.Reset();
  for (int t = 0; t < 50; ++t) classifier.Step(kSoftMoved, 0);
  EXPECT_EQ(classifier.best_class(), 3);
  EXPECT_NEAR(Sum(classifier.probability()), 1, 1e-12);
  EXPECT_EQ(classifier.stability(), 1);
}

TEST(ContactClassifierTest, DecidesOnceAfterTheAskedForFrames) {
  ContactClassifier classifier(
      SmallCompiled(), {.decision_threshold = 0.6, .decision_frames = 7});
  uint64_t first_above = 0;
  for (uint64_t t = 1; t <= 60; ++t) {
    classifier.Step(kHard, 0);
    if (first_above == 0 && classifier.probability()[0] >= 0.6) {
      first_above = t;
    }
  }
  ASSERT_TRUE(classifier.decision());
  EXPECT_EQ(classifier.decision()->class_index, 0);
  EXPECT_EQ(classifier.decision()->frame, first_above + 6);
  const uint64_t frame = classifier.decision()->frame;
  for (int t = 0; t < 200; ++t) classifier.Step(kSoftMoved, 0);
  EXPECT_EQ(classifier.decision()->frame, frame);
}

// The sums of the classes' probabilities, and the rule in plain loops.
TEST(ContactClassifierTest, EachQuestionIsDecidedWhenItsValueIsSure) {
  constexpr double kThreshold = 0.95;
  constexpr int kFrames = 6;
  ContactClassifier classifier(
      SmallCompiled(),
      {.decision_threshold = kThreshold, .decision_frames = kFrames});
  EXPECT_DOUBLE_EQ(classifier.value_probability(0)[0], 0.5);
  int run[2][2] = {};
  uint64_t decided[2] = {};
  int value[2] = {};
  uint64_t changed[2] = {};
  for (uint64_t t = 1; t <= 300; ++t) {
    classifier.Step(t < 100 ? kHard : kSoftMoved, 0);
    const auto p = classifier.probability();
    const double sums[2][2] = {{p[0] + p[1], p[2] + p[3]},
                               {p[0] + p[2], p[1] + p[3]}};
    for (int q = 0; q < 2; ++q) {
      for (int v = 0; v < 2; ++v) {
        EXPECT_DOUBLE_EQ(classifier.value_probability(q)[v], sums[q][v]);
        const bool above =
            sums[q][v] >= kThreshold && classifier.unknown() < 0.5;
        run[q][v] = above ? run[q][v] + 1 : 0;
        if (run[q][v] < kFrames) continue;
        if (decided[q] == 0) {
          decided[q] = t;
        } else if (v != value[q]) {
          changed[q] = t;
        }
        value[q] = v;
      }
      const QuestionDecision& decision = classifier.decisions()[q];
      ASSERT_EQ(decision.frame, decided[q]) << t;
      ASSERT_EQ(decision.changed_frame, changed[q]) << t;
      ASSERT_EQ(decision.value, value[q]) << t;
    }
  }
  EXPECT_GT(decided[0], 0u);
  EXPECT_GT(changed[1], 100u);
  EXPECT_EQ(classifier.decisions()[0].revised, changed[0] > 0);
  EXPECT_FALSE(classifier.decisions()[1].revised);
  classifier.Reset();
  EXPECT_FALSE(classifier.decisions()[0].decided());
  EXPECT_DOUBLE_EQ(classifier.value_probability(1)[0], 0.5);
}

TEST(ContactClassifierTest, WhatNoModelExplainsIsUnknownAndUndecided) {
  ContactClassifier classifier(SmallCompiled(), {});
  for (int t = 0; t < 50; ++t) classifier.Step({{1e9, 0, 5}, 1e9}, 0);
  EXPECT_GT(classifier.unknown(), 0.99);
  EXPECT_FALSE(classifier.decision());
  EXPECT_NEAR(Sum(classifier.probability()), 1, 1e-12);
}

// HMMs, and an untrained network that estimates some stiffness.
std::shared_ptr<const CompiledModel> Estimating(double softest) {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.estimator = RandomNetwork(2, {5}, 4, Activation::kSoftsign,
                                  GateActivation::kHardSigmoid, 9, 1, 2);
  model.calibration.softest.assign(2, softest);
  return *CompiledModel::Create(model);
}

double UnknownAfter20(const std::shared_ptr<const CompiledModel>& model,
                      Scorers scorers) {
  ContactClassifier classifier(model, {.scorers = scorers});
  for (int t = 0; t < 20; ++t) classifier.Step(kHard, 0);
  return classifier.unknown();
}

TEST(ContactClassifierTest, AnObjectSofterThanKnownOnesIsUnknown) {
  const auto all = Estimating(-50);
  const auto hard = Estimating(50);
  EXPECT_LT(UnknownAfter20(all, Scorers::kAll), 0.1);
  EXPECT_GT(UnknownAfter20(hard, Scorers::kAll), 0.9);
  // Without the estimator nothing is known of the stiffness.
  EXPECT_LT(UnknownAfter20(hard, Scorers::kHmms), 0.1);
}

TEST(ContactClassifierTest, ResetGivesTheSameBitsAgain) {
  ContactClassifier classifier(SmallCompiled(), {});
  auto run = [&] {
    Random random(11);
    for (int t = 0; t < 300; ++t) {
      const double force = random.Uniform(0, 5);
      classifier.Step({{force, 0, random.Uniform(0, 0.02)}, force}, 0);
    }
    return std::vector<double>(classifier.probability().begin(),
                               classifier.probability().end());
  };
  const auto first = run();
  classifier.Reset();
  EXPECT_EQ(run(), first);
}

TEST(ContactClassifierTest, LostFramesCountAsTime) {
  ContactClassifier classifier(SmallCompiled(), {});
  classifier.Step(kHard, 0);
  classifier.Step(kHard, 3);
  EXPECT_EQ(classifier.frames(), 5u);
  // However long the gap, the models bridge a bounded part of it.
  classifier.Step(kHard, uint64_t{1} << 60);
  EXPECT_NEAR(Sum(classifier.probability()), 1, 1e-12);
}

TEST(ContactClassifierTest, LstmsAnswerWithTheirMeanProbability) {
  Model model = testing::SmallModel();
  testing::AddLstms(2, model);
  ContactClassifier classifier(*CompiledModel::Create(model), {});
  std::vector<CompiledLstm> compiled;
  for (const LstmNetwork& network : model.lstms) {
    compiled.push_back(*CompiledLstm::Create(network));
  }
  LstmStepper first(compiled[0]);
  LstmStepper second(compiled[1]);
  const double input[] = {std::log(2.71 + 0.01), 0};
  for (int t = 0; t < 30; ++t) {
    classifier.Step(kHard, 0);
    first.Step(input);
    second.Step(input);
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(std::exp(classifier.lstm_score()[k]),
                  (first.probability()[k] + second.probability()[k]) / 2,
                  1e-12);
    }
  }
}

TEST(ContactClassifierTest, LstmsRestBetweenTheirIntervals) {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.inputs.lstm_steps = {5, 20};
  ContactClassifier classifier(*CompiledModel::Create(model), {.looks = false});
  std::vector<int> stepped;
  std::vector<double> last(4, 0.0);
  Random random(3);
  for (int t = 1; t <= 400; ++t) {
    classifier.Step({{random.Uniform(0, 4), 0, 0.001}, 1}, 0);
    const auto score = classifier.lstm_score();
    if (!std::equal(score.begin(), score.end(), last.begin())) {
      stepped.push_back(t);
      last.assign(score.begin(), score.end());
    }
  }
  // Every 5th frame to 50, a tenth of the time so far to 200, then every 20th.
  EXPECT_EQ(std::vector<int>(stepped.begin(), stepped.begin() + 12),
            (std::vector<int>{5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60}));
  EXPECT_EQ(stepped.back() - stepped[stepped.size() - 2], 20);
}

// Noise around a constant force; from frame 201 on twice as much.
ContactSample PushedOn(int t, Random& random) {
  const double force = (t <= 200 ? 2 : 4) + 0.01 * random.Gaussian();
  return {{force, 0, 0.001}, force};
}

Model ModelWithLstms() {
  Model model = testing::SmallModel();
  testing::AddLstms(2, model);
  model.inputs.lstm_steps = {5, 40};
  return model;
}

// After a look the LSTMs are where they were: at each of their steps they say
// the same as without looks.
TEST(ContactClassifierTest, LooksLeaveNoTrace) {
  const auto model = *CompiledModel::Create(ModelWithLstms());
  ContactClassifier with(model, {});
  ContactClassifier without(model, {.looks = false});
  Random random(3);
  uint64_t steps = 0;
  for (int t = 1; t <= 400; ++t) {
    const ContactSample sample = PushedOn(t, random);
    with.Step(sample, 0);
    without.Step(sample, 0);
    ASSERT_EQ(with.lstm_steps(), without.lstm_steps());
    if (with.lstm_steps() == steps) continue;
    steps = with.lstm_steps();
    ASSERT_TRUE(std::ranges::equal(with.lstm_score(), without.lstm_score()));
  }
  EXPECT_GT(with.looks(), 0u);
  EXPECT_EQ(without.looks(), 0u);
}

TEST(ContactClassifierTest, ANewCourseIsLookedAtBeforeTheNextStep) {
  Model model = ModelWithLstms();
  // Untrained networks are never sure; these always are.
  for (LstmNetwork& lstm : model.lstms) lstm.dense_bias[0] = 60;
  ContactClassifier classifier(*CompiledModel::Create(model), {});
  Random random(3);
  for (int t = 1; t <= 200; ++t) classifier.Step(PushedOn(t, random), 0);
  const uint64_t steps = classifier.lstm_steps();
  const uint64_t looks = classifier.looks();
  // Steps are 20 frames apart.
  for (int t = 201; t <= 210; ++t) classifier.Step(PushedOn(t, random), 0);
  EXPECT_EQ(classifier.lstm_steps(), steps);
  EXPECT_GT(classifier.looks(), looks);
}

TEST(ContactClassifierTest, AStateThatIsNotSureIsLookedAtInEachFrame) {
  // Untrained networks are never sure.
  ContactClassifier classifier(*CompiledModel::Create(ModelWithLstms()),
                               {.scorers = Scorers::kLstms});
  Random random(3);
  for (int t = 1; t <= 100; ++t) {
    const bool sure = classifier.lstm_steps() == 0 ||
                      std::ranges::max(classifier.value_probability(1)) >=
                          ContactClassifier::kSureState;
    const uint64_t before = classifier.lstm_steps() + classifier.looks();
    classifier.Step(PushedOn(t, random), 0);
    if (!sure) {
      EXPECT_EQ(classifier.lstm_steps() + classifier.looks(), before + 1) << t;
    }
  }
  EXPECT_GT(classifier.looks(), 50u);
}

TEST(ContactClassifierTest, OnlyStatesAreLookedAt) {
  Model model = ModelWithLstms();
  model.class_names = {"foil", "wood", "cork", "felt"};
  ContactClassifier classifier(*CompiledModel::Create(model), {});
  Random random(3);
  for (int t = 1; t <= 400; ++t) classifier.Step(PushedOn(t, random), 0);
  EXPECT_EQ(classifier.looks(), 0u);
}

// The probability of a state is what two evaluations in a row agree on; the
// classes keep their shares of it.
TEST(ContactClassifierTest, ClassesSumToWhatTheStateAgreesOn) {
  ContactClassifier classifier(*CompiledModel::Create(ModelWithLstms()), {});
  Random random(4);
  for (int t = 1; t <= 300; ++t) {
    classifier.Step({{random.Uniform(0, 4), 0, random.Uniform(0, 0.02)}, 1}, 0);
    const auto p = classifier.probability();
    EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
    EXPECT_NEAR(p[1] + p[3], classifier.value_probability(1)[1], 1e-12);
    EXPECT_NEAR(p[0] + p[1], classifier.value_probability(0)[0], 1e-12);
  }
}

// At a step, a held calibration gives the same answer as one that is read at
// every frame. Between two steps it gives the answer of the first.
TEST(ContactClassifierTest, AHeldCalibrationIsReadAtSteps) {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.inputs.hmm_steps = {4, 4};
  model.inputs.lstm_steps = {6, 6};
  model.calibration.frames = {1, 60};
  const ContactClassifier::Options no_looks = {.looks = false};
  ContactClassifier every_frame(*CompiledModel::Create(model), no_looks);
  model.calibration.held = true;
  ContactClassifier held(*CompiledModel::Create(model), no_looks);
  Random random(3);
  std::vector<double> answer;
  int moved = 0;
  for (int t = 1; t <= 60; ++t) {
    const ContactSample sample = {{random.Uniform(0, 4), 0, 0.001}, 1};
    every_frame.Step(sample, 0);
    held.Step(sample, 0);
    const auto now = every_frame.probability();
    if (t == 1 || t % 4 == 0 || t % 6 == 0)
      answer.assign(now.begin(), now.end());
    EXPECT_TRUE(std::ranges::equal(held.probability(), answer)) << t;
    moved += !std::ranges::equal(now, answer);
  }
  EXPECT_GT(moved, 20);
}

// Only frames that are due count, however few lie between.
TEST(ContactClassifierTest, AnAnswerHoldsAfterTheFramesOfTheCalibration) {
  Model model = testing::SmallModel();
  model.calibration.hold_after_frames = 20;
  const auto held = *CompiledModel::Create(model);
  ContactClassifier holding(held, {});
  ContactClassifier other(SmallCompiled(), {});
  for (int round = 0; round < 2; ++round) {
    for (int t = 0; t < 60; ++t) {
      const ContactSample& sample = t < 20 ? kHard : kSoftMoved;
      holding.Step(sample, 0);
      if (t < 20) other.Step(sample, 0);
      for (int k = 0; k < 4; ++k) {
        ASSERT_EQ(holding.log_likelihood()[k], other.log_likelihood()[k]) << t;
      }
    }
    EXPECT_EQ(holding.frames(), 60u);
    holding.Reset();
    other.Reset();
  }
}

TEST(ContactClassifierTest, HmmsRestBetweenTheirIntervals) {
  Model model = testing::SmallModel();
  ContactClassifier every_frame(*CompiledModel::Create(model), {});
  model.inputs.hmm_steps = {3, 3};
  ContactClassifier every_third(*CompiledModel::Create(model), {});
  Random random(3);
  for (int t = 1; t <= 30; ++t) {
    const ContactSample sample = {{random.Uniform(0, 4), 0, 0.001}, 1};
    every_third.Step(sample, 0);
    if (t % 3 == 0) every_frame.Step(sample, 0);
    EXPECT_EQ(every_third.hmm_steps(), static_cast<uint64_t>(t / 3));
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(every_third.log_likelihood()[k],
                every_frame.log_likelihood()[k]);
    }
  }
}

// Missing frames that were due are summed over.
TEST(ContactClassifierTest, HmmsPredictAcrossTheStepsThatWereDue) {
  Model model = testing::SmallModel();
  ContactClassifier every_frame(*CompiledModel::Create(model), {});
  model.inputs.hmm_steps = {3, 3};
  ContactClassifier every_third(*CompiledModel::Create(model), {});
  for (int t = 1; t <= 4; ++t) every_third.Step(kHard, 0);
  every_frame.Step(kHard, 0);
  every_third.Step(kSoftMoved, /*missing_before=*/7);  // 5 to 11, then 12
  every_frame.Step(kSoftMoved, /*missing_before=*/2);  // 6 and 9
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(every_third.log_likelihood()[k], every_frame.log_likelihood()[k]);
  }
}

TEST(ContactClassifierTest, AFrameAllocatesNothing) {
  Model model = testing::SmallModel();
  testing::AddLstms(2, model);
  auto compiled = CompiledModel::Create(model);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  ContactClassifier classifier(*compiled, {});
  testing::AllocationCounter counter;
  for (int t = 0; t < 1000; ++t) classifier.Step(kHard, t % 7 == 0 ? 2 : 0);
  classifier.Reset();
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
