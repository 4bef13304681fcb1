#include "core/eval/evaluate.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus {
namespace {

FitOptions QuickOptions() {
  FitOptions options;
  options.states = 3;
  options.max_iterations = 4;
  return options;
}

TEST(EvaluateProtocolTest, DistinguishesSeparateClasses) {
  const auto contacts = testing::SyntheticContacts(10, 60, 0.02, 1);
  for (const char* algorithm : {"hmm", "fused", "1nn"}) {
    auto result = EvaluateProtocol(
        testing::PointersTo(contacts), Protocol::kLeaveOneMaterialOut,
        *ParseAlgorithm(algorithm), QuickOptions(), RunSerially);
    ASSERT_TRUE(result.ok()) << algorithm << ": " << result.status();
    EXPECT_EQ(result->final.size(), 40u);
    EXPECT_GE(Accuracy(result->final), 0.95) << algorithm;
    ASSERT_EQ(result->anytime.size(), static_cast<size_t>(kAnytimeCount));
    for (const auto& outcomes : result->anytime) {
      for (const Outcome& outcome : outcomes) {
        ASSERT_EQ(outcome.probability.size(), 4u);
      }
    }
  }
}

// Labels that mean nothing: no protocol may beat chance by much, which is what
// peeking into the test folds would do.
TEST(EvaluateProtocolTest, RandomLabelsStayAtChance) {
  auto contacts = testing::SyntheticContacts(30, 30, 0.5, 1);
  Random random(9);
  const char* labels[] = {"HU", "HM", "SU", "SM"};
  for (auto& contact : contacts) contact.label = labels[random.Index(4)];
  for (const char* algorithm : {"hmm", "1nn"}) {
    auto result = EvaluateProtocol(testing::PointersTo(contacts),
                                   Protocol::kKFold, *ParseAlgorithm(algorithm),
                                   QuickOptions(), RunSerially);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_LT(Accuracy(result->final), 0.40) << algorithm;
  }
}

TEST(EvaluateModelTest, RefusesWhatTheModelCannotAnswer) {
  const auto contacts = testing::SyntheticContacts(4, 20, 0.1, 1);
  const auto pointers = testing::PointersTo(contacts);
  auto model = FitModel(pointers, QuickOptions(), RunSerially);
  ASSERT_TRUE(model.ok());
  auto compiled = *CompiledModel::Create(*model);
  for (auto algorithm : {Algorithm::kNearest, Algorithm::kLstm}) {
    EXPECT_EQ(
        ReasonOf(
            EvaluateModel(compiled, pointers, algorithm, RunSerially).status()),
        "INVALID_CONFIG");
  }
  auto other = contacts;
  other[0].label = "cork";
  EXPECT_EQ(ReasonOf(EvaluateModel(compiled, testing::PointersTo(other),
                                   Algorithm::kHmm, RunSerially)
                         .status()),
            "INVALID_CONFIG");
  auto result = EvaluateModel(compiled, pointers, Algorithm::kHmm, RunSerially);
  ASSERT_TRUE(result.ok());
  EXPECT_GE(Accuracy(result->final), 0.9);
  model->inputs.hmm.front().cue = NamedCue("row_load_0");
  compiled = *CompiledModel::Create(*model);
  EXPECT_EQ(
      ReasonOf(EvaluateModel(compiled, pointers, Algorithm::kHmm, RunSerially)
                   .status()),
      "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus
