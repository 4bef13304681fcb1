// What a stream relies on: no allocation per frame, and results that do not
// depend on how often they are read or what ran before.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hmm/hmm_bank.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"
#include "tests/reference/hmm/viterbi_filter.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

TEST(StreamingTest, FramesAllocateNothing) {
  Random random(51);
  for (const int d : {1, 2, 3, 7}) {
    HmmMixture model;
    model.log_weight = {std::log(0.5), std::log(0.5)};
    for (const bool left_right : {false, true}) {
      model.components.push_back(
          RandomModel(10, d, CovarianceType::kFull, left_right, random));
    }
    const HmmBank bank = *HmmBank::Create({&model, 1});
    BankFilter forward(bank, Score::kForward);
    BankFilter viterbi(bank, Score::kViterbi);
    std::vector<double> x = RandomObservations(model.components[0], 50, random);
    x[5 * d] = 1e8;
    const testing::AllocationCounter allocations;
    double sum = 0;
    double score = 0;
    for (int t = 0; t < 50; ++t) {
      forward.Step(Frame(x, d, t));
      viterbi.Step(Frame(x, d, t));
      forward.LogLikelihood({&score, 1});
      sum += score;
      viterbi.LogLikelihood({&score, 1});
      sum += score;
      if (t == 20) {
        forward.Skip(3);
        viterbi.Skip(3);
      }
      if (t == 40) {
        forward.Reset();
        viterbi.Reset();
      }
    }
    EXPECT_EQ(allocations.count(), 0);
    EXPECT_LT(sum, 0);
  }
}

TEST(StreamingTest, ReadingBetweenFramesChangesNoBit) {
  Random random(52);
  const GaussianHmm model =
      RandomModel(10, 3, CovarianceType::kFull, true, random);
  const CompiledHmm hmm = *CompiledHmm::Create(model);
  const std::vector<double> x = RandomObservations(model, 300, random);
  ForwardFilter batch(hmm);
  ViterbiFilter batch_viterbi(hmm);
  for (int t = 0; t < 300; ++t) {
    batch.Step(Frame(x, 3, t));
    batch_viterbi.Step(Frame(x, 3, t));
  }
  // A used and reset filter, copied half way, read at every frame.
  ForwardFilter used(hmm);
  ViterbiFilter used_viterbi(hmm);
  used.Step(Frame(x, 3, 200));
  used.Skip(5);
  used.Reset();
  used_viterbi.Step(Frame(x, 3, 200));
  used_viterbi.Skip(5);
  used_viterbi.Reset();
  EXPECT_EQ(used.log_likelihood(), 0);
  EXPECT_EQ(used_viterbi.score(), 0);
  double sum = 0;
  for (int t = 0; t < 300; ++t) {
    if (t == 150) used = ForwardFilter(used);
    used.Step(Frame(x, 3, t));
    used.Skip(0);
    used_viterbi.Step(Frame(x, 3, t));
    sum += used.log_likelihood() + used.state_posterior()[0] +
           used_viterbi.score() + used_viterbi.best_state();
  }
  EXPECT_EQ(used.log_likelihood(), batch.log_likelihood());
  EXPECT_EQ(used_viterbi.score(), batch_viterbi.score());
  EXPECT_EQ(used_viterbi.best_state(), batch_viterbi.best_state());
  EXPECT_TRUE(
      std::ranges::equal(used.state_posterior(), batch.state_posterior()));
  EXPECT_LT(sum, 0);
}

// 1e7 frames in one contact: the sum stays exact where plain addition has
// lost digits.
TEST(StreamingTest, TenMillionFrames) {
  GaussianHmm model;
  model.states = 1;
  model.dimensions = 1;
  model.covariance_type = CovarianceType::kSpherical;
  model.start = {1};
  model.transition = {1};
  model.means = {0};
  model.covariances = {1};
  const CompiledHmm hmm = *CompiledHmm::Create(model);
  ForwardFilter filter(hmm);
  const double x[] = {0.1};
  const double per_frame = -0.5 * (std::log(2 * M_PI) + 0.01);
  for (int t = 0; t < 10'000'000; ++t) filter.Step(x);
  EXPECT_NEAR(filter.log_likelihood(), 1e7 * per_frame, 1e-8);
}

}  // namespace
}  // namespace tactus::internal
