// The built-in bundles from end to end, frame by frame, against the same models
// in long double, over contacts of the random world on both skins.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/bundle/bundle.h"
#include "core/classify/contact_pipeline.h"
#include "core/sim/experiments/random_world.h"
#include "gtest/gtest.h"
#include "server/registry/default_bundle.h"
#include "tests/reference/classify/plain_classifier.h"

namespace tactus::internal::server {
namespace {

// Neither trained on nor tested with elsewhere.
constexpr uint64_t kSceneSeed = 4711;

// Networks are stepped in float, everything else in more.
constexpr double kProbabilityError = 1e-5;
// HMMs in float, relative to the log-likelihood.
constexpr double kLikelihoodError = 1e-6;

struct LargestErrors {
  double probability = 0;
  double hmm_probability = 0;
  double likelihood = 0;
  double unknown = 0;
  double stiffness = 0;
  double moved = 0;
};

void Raise(double error, double& largest) {
  // A NaN must not pass.
  if (!(error <= largest)) largest = error;
}

double Distance(std::span<const double> got,
                const PlainClassifier::Numbers& want) {
  double largest = 0;
  for (size_t k = 0; k < want.size(); ++k) {
    Raise(std::abs(got[k] - static_cast<double>(want[k])), largest);
  }
  return largest;
}

void Compare(const ContactClassifier& got, const PlainClassifier& want,
             LargestErrors& errors) {
  Raise(Distance(got.probability(), want.probability()), errors.probability);
  Raise(Distance(got.lstm_probability(), want.lstm_probability()),
        errors.probability);
  Raise(Distance(got.hmm_probability(), want.hmm_probability()),
        errors.hmm_probability);
  for (size_t k = 0; k < want.log_likelihood().size(); ++k) {
    const auto exact = static_cast<double>(want.log_likelihood()[k]);
    Raise(std::abs(got.log_likelihood()[k] - exact) / (1 + std::abs(exact)),
          errors.likelihood);
  }
  Raise(std::abs(got.unknown() - static_cast<double>(want.unknown())),
        errors.unknown);
  ASSERT_EQ(got.object().has_value(), want.object().has_value());
  if (!got.object()) return;
  Raise(
      std::abs(got.object()->log10_stiffness - want.object()->log10_stiffness),
      errors.stiffness);
  Raise(std::abs(got.object()->moved_m - want.object()->moved_m), errors.moved);
}

class ServedAnswersTest : public ::testing::Test {
 protected:
  static std::shared_ptr<const CompiledModel> Decode(absl::string_view bytes) {
    auto model = DecodeBundle(bytes);
    EXPECT_TRUE(model.ok()) << model.status();
    EXPECT_TRUE(RunWarmUp(**model).ok());
    return *model;
  }

  // Compares on `contacts` contacts; returns the number of compared frames.
  static int Run(const std::shared_ptr<const CompiledModel>& model,
                 const std::string& skin_name, int contacts,
                 LargestErrors& errors) {
    const SkinModel skin = *SkinModelNamed(skin_name);
    auto pipeline = *ContactPipeline::Create(skin.layout, model, {});
    PlainClassifier plain(model->model());
    std::vector<float> taxels(skin.layout.taxels());
    int compared = 0;
    for (int n = 0; n < contacts; ++n) {
      const auto trial = WorldTrial(skin, kSceneSeed, n);
      EXPECT_TRUE(trial.ok()) << trial.status();
      pipeline->EndTrial();
      for (size_t t = 0; t < trial->taxels.frames(); ++t) {
        trial->taxels.Decode(t, taxels.data());
        const auto contacts =
            pipeline->Step({.taxels = taxels, .pose = &trial->poses[t]});
        if (contacts.empty() || contacts[0].released()) continue;
        const ContactReport& contact = contacts[0];
        if (contact.onset) plain.Reset();
        plain.StepOrHold(
            {contact.features->sample(), contact.features->touched});
        Compare(*contact.classifier, plain, errors);
        ++compared;
      }
    }
    std::printf(
        "%s: %d frames; probability %.1e, HMMs' %.1e, likelihood %.1e, unknown "
        "%.1e, stiffness %.1e, moved %.1e m\n",
        skin_name.c_str(), compared, errors.probability, errors.hmm_probability,
        errors.likelihood, errors.unknown, errors.stiffness, errors.moved);
    return compared;
  }

  static void ExpectSmall(const LargestErrors& errors) {
    EXPECT_LT(errors.probability, kProbabilityError);
    EXPECT_LT(errors.hmm_probability, kProbabilityError);
    EXPECT_LT(errors.likelihood, kLikelihoodError);
    EXPECT_LT(errors.unknown, kProbabilityError);
    EXPECT_LT(errors.stiffness, 1e-4);
    EXPECT_LT(errors.moved, 1e-6);
  }
};

TEST_F(ServedAnswersTest, OfTheDefaultBundleAreThoseOfLongDouble) {
  const auto model = Decode(DefaultBundle());
  LargestErrors errors;
  EXPECT_GT(Run(model, "good", 6, errors), 1000);
  EXPECT_GT(Run(model, "measured", 6, errors), 1000);
  ExpectSmall(errors);
}

TEST_F(ServedAnswersTest, OfTheBundleWithoutPosesAreThoseOfLongDouble) {
  LargestErrors errors;
  EXPECT_GT(Run(Decode(NoPosesBundle()), "good", 6, errors), 1000);
  ExpectSmall(errors);
}

// The same contact in a room whose origin is a kilometre away. A double there
// still has 1e-13 m.
TEST_F(ServedAnswersTest, DoNotDependOnWhereTheOriginIs) {
  const auto model = Decode(DefaultBundle());
  const SkinModel skin = *SkinModelNamed("good");
  auto here = *ContactPipeline::Create(skin.layout, model, {});
  auto there = *ContactPipeline::Create(skin.layout, model, {});
  const Eigen::Vector3d away(1000, -700, 300);
  std::vector<float> taxels(skin.layout.taxels());
  double largest = 0;
  double largest_motion = 0;
  int compared = 0;
  for (int n = 0; n < 20; ++n) {
    const auto trial = WorldTrial(skin, kSceneSeed, n);
    ASSERT_TRUE(trial.ok()) << trial.status();
    here->EndTrial();
    there->EndTrial();
    for (size_t t = 0; t < trial->taxels.frames(); ++t) {
      trial->taxels.Decode(t, taxels.data());
      Pose pose = trial->poses[t];
      const auto near = here->Step({.taxels = taxels, .pose = &pose});
      Pose moved = pose;
      moved.position += away;
      const auto far = there->Step({.taxels = taxels, .pose = &moved});
      ASSERT_EQ(near.size(), far.size());
      if (near.empty() || near[0].released()) continue;
      Raise(std::abs(near[0].features->motion_m - far[0].features->motion_m),
            largest_motion);
      const auto a = near[0].classifier->probability();
      const auto b = far[0].classifier->probability();
      for (size_t k = 0; k < a.size(); ++k) {
        Raise(std::abs(a[k] - b[k]), largest);
      }
      ++compared;
    }
  }
  std::printf("%d frames: motion %.1e m, probability %.1e\n", compared,
              largest_motion, largest);
  EXPECT_GT(compared, 5000);
  EXPECT_LT(largest_motion, 1e-12);
  EXPECT_LT(largest, 1e-5);
}

// Taxels, offsets and poses that are denormal numbers, also after a contact of
// ordinary size.
TEST_F(ServedAnswersTest, StayFiniteWithDenormalFrames) {
  const auto model = Decode(DefaultBundle());
  const SkinModel skin = *SkinModelNamed("good");
  auto pipeline = *ContactPipeline::Create(skin.layout, model, {});
  std::vector<float> taxels(skin.layout.taxels());
  Pose pose;
  int in_contact = 0;
  for (int t = 0; t < 3000; ++t) {
    const bool pressed = t % 600 >= 200 && t % 600 < 400;
    for (size_t i = 0; i < taxels.size(); ++i) {
      const bool here = pressed && i >= 100 && i < 106;
      taxels[i] = here ? 0.5F : 1e-45F * static_cast<float>(i % 5);
    }
    pose.position.x() = 1e-310 * t;
    for (const ContactReport& contact :
         pipeline->Step({.taxels = taxels, .pose = &pose})) {
      ASSERT_TRUE(std::isfinite(contact.features->net_force));
      ASSERT_TRUE(std::isfinite(contact.features->motion_m));
      double sum = 0;
      for (const double p : contact.classifier->probability()) sum += p;
      ASSERT_NEAR(sum, 1, 1e-12) << t;
      in_contact += !contact.released();
    }
  }
  EXPECT_GT(in_contact, 900);
}

}  // namespace
}  // namespace tactus::internal::server
