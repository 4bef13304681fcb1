#include "core/lstm/train.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/errors.h"
#include "core/lstm/stepper.h"
#include "gtest/gtest.h"
#include "tests/core/lstm/training_cases.h"
#include "tests/reference/lstm/plain_lstm.h"

namespace tactus::internal {
namespace {

// Which of two pulses, on two inputs and at random times, comes first; a third
// input is noise. The target is the time since the second pulse.
TrainingSet PulseOrder(int count, uint64_t seed, int regressions = 0) {
  Random random(seed);
  TrainingSet set;
  for (int i = 0; i < count; ++i) {
    const int steps = 20 + static_cast<int>(random.Index(10));
    const int first = static_cast<int>(random.Index(8));
    const int second = first + 3 + static_cast<int>(random.Index(6));
    const int label = static_cast<int>(random.Index(2));
    std::vector<float> x, y;
    for (int t = 0; t < steps; ++t) {
      x.push_back(t == (label == 0 ? first : second) ? 1 : 0);
      x.push_back(t == (label == 0 ? second : first) ? 1 : 0);
      x.push_back(static_cast<float>(0.1 * random.Gaussian()));
      y.push_back(static_cast<float>(std::max(0, t - second)) / 10);
    }
    if (regressions == 0) y.clear();
    set.Add(std::move(x), label, std::move(y));
  }
  return set;
}

LstmNetwork SmallNetwork(int regressions = 0) {
  return RandomNetwork(3, {8, 8}, 2, Activation::kTanh,
                       GateActivation::kSigmoid, 5, /*forget_bias=*/1,
                       regressions);
}

LstmTrainOptions Options() {
  LstmTrainOptions options;
  options.epochs = 4;
  options.batch_size = 8;
  options.optimizer.optimizer = Optimizer::kAdam;
  options.optimizer.learning_rate = 0.01;
  options.optimizer.gradient_clip = 1;
  options.seed = 9;
  return options;
}

bool SameBits(const LstmNetwork& a, const LstmNetwork& b) {
  LstmNetwork left = a, right = b;
  const auto x = Tensors(left);
  const auto y = Tensors(right);
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const NamedTensor& p, const NamedTensor& q) {
                      return *p.values == *q.values;
                    });
}

// The fraction of `set` whose most likely class after the last step is right,
// and the root mean square error of the regression.
struct Skill {
  double accuracy = 0;
  double error = 0;
};

Skill SkillOf(const LstmNetwork& network, const TrainingSet& set) {
  auto lstm = CompiledLstm::Create(network);
  EXPECT_TRUE(lstm.ok()) << lstm.status();
  LstmStepper stepper(*lstm);
  Skill skill;
  for (const LstmSequence& sequence : set.views) {
    stepper.Reset();
    for (size_t at = 0; at < sequence.inputs.size(); at += 3) {
      const auto row = sequence.inputs.subspan(at, 3);
      stepper.Step(std::vector<double>(row.begin(), row.end()));
    }
    const auto p = stepper.probability();
    skill.accuracy += (p[sequence.label] > 0.5);
    if (network.regressions == 0) continue;
    const double error =
        stepper.regression_mean()[0] - double{sequence.targets.back()};
    skill.error += error * error;
  }
  const auto count = static_cast<double>(set.views.size());
  return {skill.accuracy / count, std::sqrt(skill.error / count)};
}

TEST(TrainLstmTest, LearnsTheOrderOfPulsesAndTheTimeSince) {
  const TrainingSet training = PulseOrder(200, 1, 1);
  const TrainingSet test = PulseOrder(100, 2, 1);
  for (const Optimizer optimizer : {Optimizer::kAdam, Optimizer::kRmsProp}) {
    LstmTrainOptions options = Options();
    options.epochs = 30;
    options.cosine_decay = true;
    options.optimizer.optimizer = optimizer;
    options.noise = {.dropout = 0.1, .input = 0.02};
    options.loss.steps = LstmLoss::kEveryStep;
    options.loss.first_step = 15;
    options.loss.regression_weight = 0.1;
    auto trained =
        TrainLstm({.network = SmallNetwork(1)}, training.views, {}, options);
    ASSERT_TRUE(trained.ok()) << trained.status();
    EXPECT_EQ(trained->epoch, 30);
    ASSERT_EQ(trained->history.size(), 30u);
    EXPECT_LT(trained->history.back().train_loss,
              trained->history.front().train_loss);
    EXPECT_GE(trained->history.back().train_accuracy, 0.95);
    const Skill skill = SkillOf(trained->network, test);
    EXPECT_GE(skill.accuracy, 0.97);
    // Targets spread by 0.4.
    EXPECT_LE(skill.error, 0.15);
  }
}

TEST(TrainLstmTest, TheSeedFixesTheBits) {
  const TrainingSet set = PulseOrder(30, 3);
  LstmTrainOptions options = Options();
  options.noise.input = 0.1;
  const auto train = [&] {
    return TrainLstm({.network = SmallNetwork()}, set.views, set.views, options)
        ->network;
  };
  const LstmNetwork first = train();
  EXPECT_TRUE(SameBits(train(), first));
  options.seed = 10;
  EXPECT_FALSE(SameBits(train(), first));
}

TEST(TrainLstmTest, TheLearningRateFallsAlongACosine) {
  const TrainingSet set = PulseOrder(8, 3);
  LstmTrainOptions options = Options();
  options.epochs = 2;
  options.noise = {};
  const auto networks = [&] {
    std::vector<LstmNetwork> after;
    EXPECT_TRUE(TrainLstm({.network = SmallNetwork()}, set.views, {}, options,
                          [&](const LstmEpoch&, const LstmCheckpoint& made) {
                            after.push_back(made.network);
                            return absl::OkStatus();
                          })
                    .ok());
    return after;
  };
  const auto constant = networks();
  options.cosine_decay = true;
  const auto falling = networks();
  // One batch per epoch: the first step has full length, the second half of it.
  EXPECT_TRUE(SameBits(falling[0], constant[0]));
  for (size_t k = 0; k < falling[0].dense_kernel.size(); ++k) {
    const double start = constant[0].dense_kernel[k];
    EXPECT_NEAR(falling[1].dense_kernel[k] - start,
                (constant[1].dense_kernel[k] - start) / 2, 1e-6);
  }
  EXPECT_FALSE(SameBits(falling[1], falling[0]));
}

TEST(TrainLstmTest, GoesOnFromACheckpointToTheSameBits) {
  const TrainingSet training = PulseOrder(30, 3);
  const TrainingSet validation = PulseOrder(20, 4);
  for (const Optimizer optimizer : {Optimizer::kAdam, Optimizer::kRmsProp}) {
    LstmTrainOptions options = Options();
    options.optimizer.optimizer = optimizer;
    options.cosine_decay = true;
    options.patience = 4;
    std::vector<LstmCheckpoint> checkpoints;
    auto whole = TrainLstm(
        {.network = SmallNetwork()}, training.views, validation.views, options,
        [&](const LstmEpoch& epoch, const LstmCheckpoint& checkpoint) {
          checkpoints.push_back(checkpoint);
          EXPECT_EQ(epoch.epoch, int(checkpoints.size()));
          return absl::OkStatus();
        });
    ASSERT_TRUE(whole.ok()) << whole.status();
    ASSERT_EQ(checkpoints.size(), 4u);
    for (const LstmCheckpoint& checkpoint : checkpoints) {
      auto rest =
          TrainLstm(checkpoint, training.views, validation.views, options);
      ASSERT_TRUE(rest.ok()) << rest.status();
      EXPECT_TRUE(SameBits(rest->network, whole->network));
      EXPECT_EQ(rest->epoch, whole->epoch);
      ASSERT_EQ(rest->history.size(), 4u);
      EXPECT_EQ(rest->history.back().train_loss,
                whole->history.back().train_loss);
    }
  }
}

TEST(TrainLstmTest, ACheckpointOfOtherOptionsIsRefused) {
  const TrainingSet set = PulseOrder(10, 3);
  LstmTrainOptions options = Options();
  options.patience = 4;
  LstmCheckpoint good;
  ASSERT_TRUE(TrainLstm({.network = SmallNetwork()}, set.views, set.views,
                        options,
                        [&](const LstmEpoch&, const LstmCheckpoint& made) {
                          good = made;
                          return absl::OkStatus();
                        })
                  .ok());
  const auto reason = [&](const LstmCheckpoint& from) {
    return ReasonOf(TrainLstm(from, set.views, set.views, options).status());
  };
  EXPECT_EQ(reason(good), "");
  LstmCheckpoint bad = good;
  bad.network =
      RandomNetwork(3, {4}, 2, Activation::kTanh, GateActivation::kSigmoid, 1);
  EXPECT_EQ(reason(bad), "INVALID_MODEL");
  bad = good;
  bad.best_epoch = 5;
  EXPECT_EQ(reason(bad), "INVALID_MODEL");
  bad = good;
  bad.best = {};
  EXPECT_EQ(reason(bad), "INVALID_MODEL");
  options.optimizer.optimizer = Optimizer::kRmsProp;
  EXPECT_EQ(reason(good), "INVALID_MODEL");
  options = Options();
  EXPECT_EQ(reason(good), "INVALID_MODEL");
}

TEST(TrainLstmTest, PatienceEndsTrainingAndGivesTheBestEpoch) {
  const TrainingSet training = PulseOrder(20, 3);
  // Exchanged labels: the better the fit, the larger the validation loss.
  TrainingSet validation = PulseOrder(40, 4);
  for (LstmSequence& sequence : validation.views) {
    sequence.label = 1 - sequence.label;
  }
  LstmTrainOptions options = Options();
  options.epochs = 100;
  options.patience = 3;
  std::vector<LstmNetwork> networks;
  auto trained = TrainLstm(
      {.network = SmallNetwork()}, training.views, validation.views, options,
      [&](const LstmEpoch&, const LstmCheckpoint& checkpoint) {
        networks.push_back(checkpoint.network);
        return absl::OkStatus();
      });
  ASSERT_TRUE(trained.ok()) << trained.status();
  const auto& history = trained->history;
  ASSERT_LT(history.size(), 100u);
  EXPECT_EQ(int(history.size()), trained->epoch + 3);
  const auto best =
      std::min_element(history.begin(), history.end(),
                       [](const LstmEpoch& a, const LstmEpoch& b) {
                         return a.validation_loss < b.validation_loss;
                       });
  EXPECT_EQ(best->epoch, trained->epoch);
  EXPECT_TRUE(SameBits(trained->network, networks[trained->epoch - 1]));
}

TEST(TrainLstmTest, ValidationIsTheNetworkAsItIsUsed) {
  const TrainingSet training = PulseOrder(40, 3);
  const TrainingSet validation = PulseOrder(70, 4);
  LstmTrainOptions options = Options();
  // Heavy noise that must not reach the validation.
  options.noise = {.dropout = 0.8, .input = 3};
  options.optimizer.learning_rate = 0;
  options.epochs = 1;
  const LstmNetwork network = SmallNetwork();
  auto trained = TrainLstm({.network = network}, training.views,
                           validation.views, options);
  ASSERT_TRUE(trained.ok()) << trained.status();
  EXPECT_TRUE(SameBits(trained->network, network));
  EXPECT_NEAR(trained->history[0].validation_loss,
              PlainLoss(network, validation.views, options.loss), 1e-6);
  EXPECT_NE(trained->history[0].train_loss,
            PlainLoss(network, training.views, options.loss));
  EXPECT_EQ(trained->history[0].validation_accuracy,
            SkillOf(network, validation).accuracy);
}

TEST(TrainLstmTest, TheSinkEndsTheTraining) {
  const TrainingSet set = PulseOrder(5, 3);
  int epochs = 0;
  const auto status =
      TrainLstm({.network = SmallNetwork()}, set.views, {}, Options(),
                [&](const LstmEpoch&, const LstmCheckpoint&) {
                  return ++epochs < 2 ? absl::OkStatus()
                                      : absl::CancelledError("enough");
                })
          .status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(epochs, 2);
}

TEST(TrainLstmTest, ALossThatOutgrowsItsNumbersIsAFailure) {
  const TrainingSet set = PulseOrder(10, 3, 1);
  LstmNetwork network = SmallNetwork(1);
  // Variance exp(-1000).
  network.dense_bias.back() = -1000;
  EXPECT_EQ(
      ReasonOf(
          TrainLstm({.network = network}, set.views, {}, Options()).status()),
      "NUMERICAL_FAILURE");
  LstmTrainOptions options = Options();
  options.optimizer.learning_rate = 1e9;
  EXPECT_EQ(
      ReasonOf(TrainLstm({.network = SmallNetwork(1)}, set.views, {}, options)
                   .status()),
      "NUMERICAL_FAILURE");
}

TEST(TrainLstmTest, EachBadOptionIsRefusedByName) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    void (*spoil)(LstmTrainOptions&);
  };
  const Case cases[] = {
      {"epochs", [](auto& o) { o.epochs = 0; }},
      {"batch_size", [](auto& o) { o.batch_size = 0; }},
      {"patience", [](auto& o) { o.patience = -1; }},
      {"patience", [](auto& o) { o.patience = 1; }},
      {"dropout", [](auto& o) { o.noise.dropout = 1; }},
      {"input noise", [](auto& o) { o.noise.input = kNan; }},
      {"learning_rate", [](auto& o) { o.optimizer.learning_rate = -1; }},
      {"rms_decay", [](auto& o) { o.optimizer.rms_decay = 1; }},
      {"first_decay", [](auto& o) { o.optimizer.first_decay = -0.1; }},
      {"second_decay", [](auto& o) { o.optimizer.second_decay = kNan; }},
      {"epsilon", [](auto& o) { o.optimizer.epsilon = 0; }},
      {"weight_decay", [](auto& o) { o.optimizer.weight_decay = -1; }},
      {"gradient_clip", [](auto& o) { o.optimizer.gradient_clip = kNan; }},
      {"first_step", [](auto& o) { o.loss.first_step = -1; }},
      {"stride", [](auto& o) { o.loss.stride = 0; }},
      {"label_smoothing", [](auto& o) { o.loss.label_smoothing = 1; }},
      {"regression_weight", [](auto& o) { o.loss.regression_weight = kNan; }},
  };
  const TrainingSet set = PulseOrder(5, 3);
  for (const Case& c : cases) {
    LstmTrainOptions options = Options();
    c.spoil(options);
    const absl::Status status =
        TrainLstm({.network = SmallNetwork()}, set.views, {}, options).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << c.field;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.field);
  }
}

TEST(TrainLstmTest, EachBadSequenceIsRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> good(6), bad = {0, 0, kNan};
  const LstmSequence cases[] = {
      {},
      {.inputs = std::span(good).first(4)},
      {.inputs = bad},
      {.inputs = good, .label = 2},
      {.inputs = good, .label = -1},
      {.inputs = good, .targets = std::span(good).first(1)},
      {.inputs = good, .targets = std::span(bad).last(2)},
      {.inputs = good, .weight = -1},
      {.inputs = good, .weight = kNan},
  };
  const LstmNetwork network = SmallNetwork(1);
  for (const LstmSequence& sequence : cases) {
    for (const bool training : {false, true}) {
      const std::vector<LstmSequence> spoilt = {{.inputs = good}, sequence};
      const std::vector<LstmSequence> sound = {{.inputs = good}};
      const absl::Status status =
          TrainLstm({.network = network}, training ? spoilt : sound,
                    training ? sound : spoilt, Options())
              .status();
      EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
      EXPECT_NE(status.message().find("sequence 1"), std::string::npos)
          << status;
    }
  }
  EXPECT_EQ(
      ReasonOf(TrainLstm({.network = network}, {}, {}, Options()).status()),
      "INVALID_TRAINING_DATA");
  EXPECT_EQ(ReasonOf(TrainLstm({}, {}, {}, Options()).status()),
            "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
