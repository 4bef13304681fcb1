// The bank against one log-domain filter per model.

#include "core/hmm/hmm_bank.h"

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "hwy/targets.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"
#include "tests/reference/hmm/viterbi_filter.h"

namespace tactus::internal {
namespace {

// Scores of a class by the log-domain filters of its components.
class Reference {
 public:
  Reference(const HmmMixture& mixture, Score score)
      : mixture_(mixture), score_(score) {
    for (const GaussianHmm& model : mixture.components) {
      models_.push_back(*CompiledHmm::Create(model));
    }
    for (const CompiledHmm& model : models_) {
      forward_.emplace_back(model);
      viterbi_.emplace_back(model);
    }
  }

  void Step(std::span<const double> x) {
    for (ForwardFilter& filter : forward_) filter.Step(x);
    for (ViterbiFilter& filter : viterbi_) filter.Step(x);
  }

  void Skip(int missing) {
    for (ForwardFilter& filter : forward_) filter.Skip(missing);
    for (ViterbiFilter& filter : viterbi_) filter.Skip(missing);
  }

  double LogLikelihood() const {
    std::vector<double> term;
    for (size_t k = 0; k < models_.size(); ++k) {
      term.push_back(mixture_.log_weight[k] +
                     (score_ == Score::kForward ? forward_[k].log_likelihood()
                                                : viterbi_[k].score()));
    }
    const double largest = *std::ranges::max_element(term);
    double sum = 0;
    for (const double t : term) sum += std::exp(t - largest);
    return largest + std::log(sum);
  }

 private:
  HmmMixture mixture_;
  Score score_;
  std::vector<CompiledHmm> models_;
  std::vector<ForwardFilter> forward_;
  std::vector<ViterbiFilter> viterbi_;
};

// Classes of 1 to `most` components of 1 to 12 states.
std::vector<HmmMixture> RandomCategories(int dimensions, CovarianceType type,
                                         bool left_right, int most,
                                         Random& random) {
  std::vector<HmmMixture> categories(3);
  for (HmmMixture& category : categories) {
    const int count = 1 + static_cast<int>(random.Index(most));
    for (int k = 0; k < count; ++k) {
      category.log_weight.push_back(-std::log(count));
      category.components.push_back(
          RandomModel(1 + static_cast<int>(random.Index(12)), dimensions, type,
                      left_right, random));
    }
  }
  return categories;
}

// Scores of one stream with a gap, an outlier and a reset.
void ExpectAgreement(const std::vector<HmmMixture>& categories,
                     const std::vector<double>& x) {
  const HmmBank bank = *HmmBank::Create(categories);
  const int d = bank.dimensions();
  for (const Score score : {Score::kForward, Score::kViterbi}) {
    BankFilter filter(bank, score);
    std::vector<double> got(categories.size());
    for (int round = 0; round < 2; ++round) {
      filter.Reset();
      filter.LogLikelihood(got);
      EXPECT_EQ(got, std::vector<double>(categories.size(), 0.0));
      std::vector<Reference> references;
      for (const HmmMixture& category : categories) {
        references.emplace_back(category, score);
      }
      for (int t = 0; t * d < static_cast<int>(x.size()); ++t) {
        filter.Skip(t % 16 == 5 ? 3 : 0);
        filter.Step(Frame(x, d, t));
        filter.LogLikelihood(got);
        for (size_t c = 0; c < categories.size(); ++c) {
          if (t % 16 == 5) references[c].Skip(3);
          references[c].Step(Frame(x, d, t));
          const double want = references[c].LogLikelihood();
          ASSERT_NEAR(got[c], want, 1e-6 * (t + std::abs(want)))
              << "category " << c << " frame " << t;
        }
      }
    }
  }
}

TEST(HmmBankTest, EveryShapeScoresAsOneFilterPerModel) {
  Random random(61);
  for (const CovarianceType type :
       {CovarianceType::kFull, CovarianceType::kDiagonal,
        CovarianceType::kSpherical}) {
    for (const int d : {1, 2, 3, 5, 16}) {
      for (const bool left_right : {false, true}) {
        const auto categories =
            RandomCategories(d, type, left_right, 3, random);
        std::vector<double> x =
            RandomObservations(categories[0].components[0], 40, random);
        x[11 * d] = 1e4;
        ExpectAgreement(categories, x);
      }
    }
  }
}

TEST(HmmBankTest, ManyComponentsFillSeveralBlocks) {
  Random random(62);
  std::vector<HmmMixture> categories(4);
  for (HmmMixture& category : categories) {
    for (int k = 0; k < 9; ++k) {
      category.log_weight.push_back(-std::log(9));
      category.components.push_back(
          RandomModel(10, 3, CovarianceType::kFull, true, random));
    }
  }
  ExpectAgreement(categories,
                  RandomObservations(categories[2].components[4], 100, random));
}

// The exponents of a component's shares grow until they cost digits. This
// happens after a different number of frames for each component.
TEST(HmmBankTest, ComponentsGatherBitsAtDifferentRates) {
  Random random(66);
  std::vector<HmmMixture> categories;
  for (const double distance : {0.0, 30.0, 300.0, 1100.0, 0.0}) {
    HmmMixture category = {
        .log_weight = {0},
        .components = {RandomModel(3, 3, CovarianceType::kFull, true, random)}};
    for (double& mean : category.components[0].means) mean += distance;
    categories.push_back(std::move(category));
  }
  for (double& value : categories.back().components[0].covariances) {
    value *= 1e-8;
  }
  ExpectAgreement(categories,
                  RandomObservations(categories[0].components[0], 400, random));
}

// The instruction set that this CPU takes by default, and those of older CPUs.
TEST(HmmBankTest, EveryInstructionSetAgrees) {
  Random random(63);
  const auto categories =
      RandomCategories(3, CovarianceType::kFull, true, 20, random);
  const std::vector<double> x =
      RandomObservations(categories[1].components[0], 100, random);
  const int64_t all = hwy::SupportedTargets();
  std::vector<int64_t> targets;
  for (int64_t rest = all; rest != 0; rest &= rest - 1) {
    targets.push_back(rest & -rest);
  }
  for (const int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    ExpectAgreement(categories, x);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

TEST(HmmBankTest, WhatFloatCannotHoldIsScoredInDouble) {
  Random random(64);
  auto categories = RandomCategories(2, CovarianceType::kFull, true, 2, random);
  EXPECT_EQ(ScoredInDouble(categories), 0);
  // Nearly singular, and far from the scale of the others.
  const double tight[] = {1, 1 - 0x1p-40, 1 - 0x1p-40, 1};
  std::ranges::copy(tight, categories[0].components[0].covariances.begin());
  for (double& mean : categories[1].components[0].means) mean += 1e13;
  EXPECT_EQ(ScoredInDouble(categories), 2);
  ExpectAgreement(categories,
                  RandomObservations(categories[2].components[0], 60, random));
}

TEST(HmmBankTest, DimensionsMustAgree) {
  Random random(65);
  auto categories = RandomCategories(2, CovarianceType::kFull, true, 1, random);
  categories[2].components = {
      RandomModel(2, 3, CovarianceType::kFull, true, random)};
  const absl::Status status = HmmBank::Create(categories).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_MODEL");
  EXPECT_EQ(InfoOf(status).metadata().at("field"), "HMM dimensions");
  categories[2].components.clear();
  EXPECT_EQ(ReasonOf(HmmBank::Create(categories).status()), "INVALID_MODEL");
  EXPECT_EQ(ReasonOf(HmmBank::Create({}).status()), "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
