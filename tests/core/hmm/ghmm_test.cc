// Our scores and one Baum-Welch update against libghmm's.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/hmm/baum_welch.h"
#include "gtest/gtest.h"
#include "tests/bench/ghmm_peer.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"
#include "tests/reference/hmm/viterbi_filter.h"

namespace tactus::internal {
namespace {

constexpr double kRelative = 1e-9;

// libghmm's covariances are about the old means; these are about the new.
GaussianHmm TrainOnceWithGhmm(const GaussianHmm& model,
                              const std::vector<SequenceView>& sequences) {
  const auto peer = client::MakeGhmmPeer(model);
  EXPECT_TRUE(peer->Train(sequences, 1).ok());
  GaussianHmm out = peer->model();
  const int d = model.dimensions;
  for (int s = 0; s < model.states; ++s) {
    for (int a = 0; a < d; ++a) {
      for (int b = 0; b < d; ++b) {
        out.covariances[(s * d + a) * d + b] -=
            (out.means[s * d + a] - model.means[s * d + a]) *
            (out.means[s * d + b] - model.means[s * d + b]);
      }
    }
  }
  return out;
}

TEST(GhmmTest, ScoresAgree) {
  Random random(31);
  double worst = 0;
  for (int round = 0; round < 20; ++round) {
    for (const CovarianceType type :
         {CovarianceType::kFull, CovarianceType::kDiagonal,
          CovarianceType::kSpherical}) {
      for (const int d : {1, 2, 3}) {
        for (const bool left_right : {false, true}) {
          const int n = 1 + static_cast<int>(random.Index(12));
          const GaussianHmm model = RandomModel(n, d, type, left_right, random);
          const int frames = 1 + static_cast<int>(random.Index(500));
          std::vector<double> x = RandomObservations(model, frames, random);
          const CompiledHmm hmm = *CompiledHmm::Create(model);
          ForwardFilter forward(hmm);
          ViterbiFilter viterbi(hmm);
          for (int t = 0; t < frames; ++t) {
            forward.Step(Frame(x, d, t));
            viterbi.Step(Frame(x, d, t));
          }
          const auto peer = client::MakeGhmmPeer(model);
          const double want = *peer->LogLikelihood(x);
          const double want_viterbi = *peer->ViterbiScore(x);
          EXPECT_NEAR(forward.log_likelihood(), want,
                      kRelative * std::abs(want));
          EXPECT_NEAR(viterbi.score(), want_viterbi,
                      kRelative * std::abs(want_viterbi));
          worst =
              std::max({worst, std::abs(forward.log_likelihood() / want - 1),
                        std::abs(viterbi.score() / want_viterbi - 1)});
        }
      }
    }
  }
  RecordProperty("worst_relative_difference_e15", std::to_string(worst * 1e15));
}

TEST(GhmmTest, OneBaumWelchUpdateAgrees) {
  Random random(32);
  for (const int d : {1, 2, 3}) {
    for (const bool left_right : {false, true}) {
      GaussianHmm model =
          RandomModel(4, d, CovarianceType::kFull, left_right, random);
      std::vector<std::vector<double>> data;
      std::vector<SequenceView> views;
      for (int s = 0; s < 5; ++s) {
        data.push_back(RandomObservations(model, 60 + 7 * s, random));
      }
      for (const std::vector<double>& x : data) {
        views.push_back({x.data(), static_cast<int>(x.size()) / d, d});
      }
      const GaussianHmm want = TrainOnceWithGhmm(model, views);
      ASSERT_TRUE(BaumWelch(views,
                            {.max_iterations = 1, .left_right = left_right},
                            model)
                      .ok());
      const auto expect_near = [](const std::vector<double>& got,
                                  const std::vector<double>& wanted) {
        ASSERT_EQ(got.size(), wanted.size());
        for (size_t k = 0; k < got.size(); ++k) {
          EXPECT_NEAR(got[k], wanted[k], kRelative * (1 + std::abs(wanted[k])));
        }
      };
      expect_near(model.start, want.start);
      expect_near(model.transition, want.transition);
      expect_near(model.means, want.means);
      expect_near(model.covariances, want.covariances);
    }
  }
}

}  // namespace
}  // namespace tactus::internal
