// Evaluating the HMMs or the LSTMs alone reported the decisions of both fused.
#include "core/eval/evaluate.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

std::vector<std::pair<double, bool>> Decisions(const Model& model,
                                               Algorithm algorithm) {
  const auto contacts = testing::SyntheticContacts(6, 60, 0.1, 1);
  const auto result =
      EvaluateModel(*CompiledModel::Create(model),
                    testing::PointersTo(contacts), algorithm, RunSerially);
  EXPECT_TRUE(result.ok()) << result.status();
  std::vector<std::pair<double, bool>> decisions;
  for (const auto& decision : result->decisions) {
    decisions.push_back(decision ? std::pair(decision->seconds, decision->right)
                                 : std::pair(-1.0, false));
  }
  return decisions;
}

class DecisionOfAnotherAlgorithmTest : public ::testing::Test {
 protected:
  // Untrained networks whose probabilities are close to 0 and 1.
  DecisionOfAnotherAlgorithmTest() : both_(hmms_) {
    testing::AddLstms(2, both_);
    both_.calibration.lstm_inverse_temperature = {40, 40};
  }

  const Model hmms_ = testing::SmallModel();
  Model both_;
};

TEST_F(DecisionOfAnotherAlgorithmTest, HmmsDecideAsIfThereWereNoLstms) {
  const auto expected = Decisions(hmms_, Algorithm::kHmm);
  EXPECT_EQ(Decisions(both_, Algorithm::kHmm), expected);
  EXPECT_NE(Decisions(both_, Algorithm::kFused), expected);
}

// Fused with all weight on the LSTMs, and with evidence that makes no contact
// unknown, is the LSTMs alone.
TEST_F(DecisionOfAnotherAlgorithmTest, LstmsDecideAsIfTheyHadAllWeight) {
  Model heavy = both_;
  heavy.calibration.hmm_weight = {0, 0};
  heavy.calibration.lstm_weight = {1, 1};
  heavy.calibration.evidence_median = {-1e6, -1e6};
  const auto expected = Decisions(heavy, Algorithm::kFused);
  EXPECT_EQ(Decisions(both_, Algorithm::kLstm), expected);
  EXPECT_NE(Decisions(both_, Algorithm::kFused), expected);
}

}  // namespace
}  // namespace tactus::internal
