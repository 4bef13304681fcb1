// The stress set: for all scenes, models and numbers, either the model is
// refused or the classifier returns finite, normalised probabilities. Frames
// that StreamSession refuses are in tests/server/session/bad_input_test.cc. The
// exactness of the scores is tested in tests/core/hmm/precision_test.cc and
// long_contact_test.cc.
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/classify/contact_pipeline.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

void ExpectDistribution(std::span<const double> p) {
  for (const double value : p) ASSERT_TRUE(value >= 0 && value <= 1) << value;
  ASSERT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
}

void ExpectSound(const ContactClassifier& c) {
  ExpectDistribution(c.probability());
  ExpectDistribution(c.hmm_probability());
  if (!c.lstm_probability().empty()) ExpectDistribution(c.lstm_probability());
  for (const double score : c.log_likelihood()) {
    ASSERT_TRUE(std::isfinite(score)) << score;
  }
  ASSERT_TRUE(c.unknown() >= 0 && c.unknown() <= 1) << c.unknown();
  ASSERT_TRUE(c.stability() >= 0 && c.stability() <= 1) << c.stability();
  if (c.object()) {
    ASSERT_TRUE(std::isfinite(c.object()->moved_m));
    ASSERT_TRUE(std::isfinite(c.object()->log10_stiffness));
    ASSERT_TRUE(std::isfinite(c.object()->moved_deviation_m));
  }
}

// HMMs and networks, on the raw features and on each kind of cue.
Model FullModel() {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.inputs.lstm = {{NamedCue("log_spring")},
                       {NamedCue("area_response_long")}};
  model.estimator = RandomNetwork(2, {5}, 4, Activation::kSoftsign,
                                  GateActivation::kHardSigmoid, 9, 1, 2);
  model.calibration.softest = {5, 5};
  return model;
}

std::unique_ptr<ContactClassifier> Make(const Model& model) {
  return std::make_unique<ContactClassifier>(*CompiledModel::Create(model),
                                             ContactClassifier::Options{});
}

// 300 frames of `sample(t)`.
template <typename Sample>
void ExpectSoundContact(const Model& model, Sample sample) {
  const auto classifier = Make(model);
  for (int t = 0; t < 300; ++t) {
    const FeatureVector x = sample(t);
    classifier->Step({x, x[0]}, 0);
    ASSERT_NO_FATAL_FAILURE(ExpectSound(*classifier)) << "frame " << t;
  }
}

FeatureVector Press(int t) { return {0.02 * t, 1e-4 * t, 1e-4 * t}; }

TEST(StressTest, OutliersThatUnderflowEveryState) {
  ExpectSoundContact(FullModel(), [](int t) {
    return t % 7 == 0 ? FeatureVector{1e6, 1e6, 1e6} : Press(t);
  });
  ExpectSoundContact(FullModel(), [](int) {
    return FeatureVector{1e6, 1, 1e6};
  });
}

TEST(StressTest, ConstantFeatures) {
  for (const double value : {0.0, 1.0, 1e-3}) {
    ExpectSoundContact(FullModel(), [value](int) {
      return FeatureVector{value, value, value};
    });
  }
}

TEST(StressTest, DenormalsAndForcesOfAnySize) {
  for (double force = 1e-30; force < 1e31; force *= 10) {
    ExpectSoundContact(FullModel(), [force](int t) {
      return FeatureVector{force * (1 + t % 3), 1e-3, 1e-3};
    });
  }
  ExpectSoundContact(FullModel(), [](int t) {
    return FeatureVector{kDenormal * t, kDenormal, kDenormal * (t % 3)};
  });
  ExpectSoundContact(FullModel(), [](int t) {
    const double huge = t % 2 == 0 ? 1e308 : 1e-308;
    return FeatureVector{huge, huge, huge};
  });
}

TEST(StressTest, StatesThatAreEqualOrCannotBeReached) {
  Model model = FullModel();
  for (HmmMixture& mixture : model.hmms) {
    GaussianHmm& hmm = mixture.components[0];
    hmm.means = {0, 0, 0, 0};
    hmm.covariances = {1, 1, 1, 1};
  }
  ExpectSoundContact(model, Press);
  // No transition enters the second state, and none leaves the first.
  model = FullModel();
  for (HmmMixture& mixture : model.hmms) {
    mixture.components[0].transition = {1, 0, 0, 1};
  }
  ExpectSoundContact(model, [](int t) {
    return t < 100 ? Press(t) : FeatureVector{1e4, 1, 1};
  });
}

TEST(StressTest, CovariancesNearlySingularOrHuge) {
  for (const double variance : {1e-12, 1e12, 1e-100, 1e100}) {
    Model model = FullModel();
    for (HmmMixture& mixture : model.hmms) {
      mixture.components[0].covariances = {variance, 1, 1, variance};
    }
    ExpectSoundContact(model, Press);
  }
  Model model = FullModel();
  for (HmmMixture& mixture : model.hmms) {
    GaussianHmm& hmm = mixture.components[0];
    hmm.covariance_type = CovarianceType::kFull;
    const double tight = 1 - 0x1p-40;
    hmm.covariances = {1, tight, tight, 1, 1, tight, tight, 1};
  }
  ExpectSoundContact(model, Press);
}

TEST(StressTest, ModelsWithoutMeaningAreRefused) {
  for (const double bad : {0.0, -1.0, kNan, kInf}) {
    Model model = FullModel();
    model.hmms[1].components[0].covariances[2] = bad;
    EXPECT_EQ(ReasonOf(CompiledModel::Create(model).status()), "INVALID_MODEL");
  }
  for (const double bad : {-0.1, 1.1, kNan, kInf}) {
    Model model = FullModel();
    model.hmms[2].components[0].transition[0] = bad;
    EXPECT_EQ(ReasonOf(CompiledModel::Create(model).status()), "INVALID_MODEL");
  }
  for (const double bad : {kNan, kInf}) {
    Model model = FullModel();
    model.hmms[0].components[0].means[1] = bad;
    EXPECT_EQ(ReasonOf(CompiledModel::Create(model).status()), "INVALID_MODEL");
  }
}

// A filter must stay finite at these values, although no session accepts them.
TEST(StressTest, NumbersThatAreNoneLeaveTheHmmsNormalised) {
  for (const double bad : {kNan, kInf, -kInf}) {
    ExpectSoundContact(testing::SmallModel(), [bad](int t) {
      return t == 50 ? FeatureVector{bad, bad, bad} : Press(t);
    });
  }
}

// Only the counts grow with a contact. The score is the sum of equal terms, so
// its value is known.
TEST(StressTest, TenMillionFramesInOneContact) {
  Model model = testing::SmallModel();
  for (HmmMixture& mixture : model.hmms) {
    GaussianHmm& hmm = mixture.components[0];
    std::copy_n(hmm.means.begin() + 2, 2, hmm.means.begin());
    std::copy_n(hmm.covariances.begin() + 2, 2, hmm.covariances.begin());
  }
  model.inputs.hmm_steps = {5, 20};
  const auto classifier = Make(model);
  const ContactSample sample = {{2.7, 1e-3, 0.01}, 2.7};
  constexpr uint64_t kFrames = 10'000'000;
  for (uint64_t t = 0; t < kFrames; ++t) {
    classifier->Step(sample, 0);
    if (t % 1'000'000 != 0) continue;
    ASSERT_NO_FATAL_FAILURE(ExpectSound(*classifier));
  }
  EXPECT_EQ(classifier->frames(), kFrames);
  EXPECT_GT(classifier->skipped()[SkipRule::kUnchangedScores], 9'000'000u);
  const double x[] = {std::log(2.7 + 0.01), 0.01 * 100};
  for (int k = 0; k < 4; ++k) {
    const GaussianHmm& hmm = model.hmms[k].components[0];
    long double frame = 0;
    for (int d = 0; d < 2; ++d) {
      const long double z = x[d] - hmm.means[2 + d];
      const long double variance = hmm.covariances[2 + d];
      frame -= (z * z / variance + std::log(2 * M_PIl * variance)) / 2;
    }
    const auto want = static_cast<double>(
        frame * static_cast<long double>(classifier->hmm_steps()));
    EXPECT_NEAR(classifier->log_likelihood()[k], want, 1e-6 * std::abs(want));
  }
}

class SkinStressTest : public ::testing::Test {
 protected:
  // The largest skin there is.
  static SkinLayout LargestSkin(Connectivity connectivity) {
    SkinLayout layout = *LayoutPreset("cody-forearm");
    layout.rows = layout.columns = 64;
    layout.connectivity = connectivity;
    layout.mask.clear();
    return layout;
  }

  static std::unique_ptr<ContactPipeline> Make(const SkinLayout& layout) {
    ContactPipeline::Options options;
    options.release_after_s = 0.01;
    return *ContactPipeline::Create(layout, *CompiledModel::Create(FullModel()),
                                    options);
  }
};

TEST_F(SkinStressTest, SingleFrameContacts) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  const auto pipeline = Make(layout);
  std::vector<float> taxels(layout.taxels());
  for (int t = 0; t < 2000; ++t) {
    taxels[t % taxels.size()] = t % 2 == 0 ? 3.0F : 0.0F;
    if (t % 2 != 0) std::ranges::fill(taxels, 0.0F);
    const auto contacts = pipeline->Step({.taxels = taxels});
    ASSERT_EQ(contacts.size(), 1u);
    ASSERT_NO_FATAL_FAILURE(ExpectSound(*contacts[0].classifier));
    EXPECT_EQ(contacts[0].onset, t % 2 == 0);
    EXPECT_EQ(contacts[0].released(), t % 2 != 0);
  }
  EXPECT_EQ(pipeline->contacts_begun(), 1000u);
}

TEST_F(SkinStressTest, AllTaxelsAndCheckerboards) {
  for (const Connectivity connectivity :
       {Connectivity::kFour, Connectivity::kEight}) {
    const SkinLayout layout = LargestSkin(connectivity);
    const auto pipeline = Make(layout);
    std::vector<float> taxels(layout.taxels());
    for (int t = 0; t < 60; ++t) {
      const bool checkerboard = t % 2 != 0;
      for (int i = 0; i < layout.taxels(); ++i) {
        const bool white = (i / 64 + i) % 2 == 0;
        taxels[i] = checkerboard && white ? 0 : 2.0F + 0.1F * t;
      }
      const auto contacts = pipeline->Step({.taxels = taxels});
      const bool split = checkerboard && connectivity == Connectivity::kFour;
      EXPECT_EQ(pipeline->tracker().regions(), split ? 2048 : 1);
      // The parts are near each other: they are one contact.
      ASSERT_EQ(contacts.size(), 1u);
      ASSERT_NO_FATAL_FAILURE(ExpectSound(*contacts[0].classifier));
      EXPECT_EQ(contacts[0].features->area_taxels,
                split ? 1 : (checkerboard ? 2048 : 4096));
    }
  }
}

// Taxels as large and as small as a float may be.
TEST_F(SkinStressTest, TaxelsOfAnySize) {
  SkinLayout layout = LargestSkin(Connectivity::kEight);
  layout.contact_threshold = layout.onset_threshold = 1e-38;
  const auto pipeline = Make(layout);
  std::vector<float> taxels(layout.taxels());
  Random random(6);
  for (int t = 0; t < 200; ++t) {
    const auto size = static_cast<float>(std::pow(10, random.Uniform(-45, 38)));
    for (float& taxel : taxels) taxel = size;
    taxels[t] = std::numeric_limits<float>::quiet_NaN();
    for (const ContactReport& contact : pipeline->Step({.taxels = taxels})) {
      ASSERT_NO_FATAL_FAILURE(ExpectSound(*contact.classifier));
      ASSERT_TRUE(std::isfinite(contact.features->net_force));
    }
  }
}

}  // namespace
}  // namespace tactus::internal
