#include "core/classify/feature_input.h"

#include <cmath>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus {
namespace {

TEST(MakeInputTest, TransformsThenScalesInTheOrderOfTheSpec) {
  FeatureSpec spec;
  spec.features = {Feature::kMotion, Feature::kForce};
  spec.log_offset = {0, 0.5};
  const std::vector<FeatureScaling> scaling = {{1, 10}, {0, 2}};
  const FeatureVector features = {2.0, 9.0, 3.0};  // force, area, motion
  double out[2];
  MakeInput(spec, scaling, features, out);
  EXPECT_DOUBLE_EQ(out[0], 20);
  EXPECT_DOUBLE_EQ(out[1], 2 * std::log(2.5));
}

TEST(MakeInputTest, NegativeNoiseIsClampedBeforeTheLogarithm) {
  FeatureSpec spec;
  spec.features = {Feature::kForce};
  spec.log_offset = {0.01};
  EXPECT_DOUBLE_EQ(TransformFeature(spec, 0, {-3, 0, 0}), std::log(0.01));
}

TEST(ValidateFeatureSpecTest, EachSpoiltFieldIsRefused) {
  const FeatureSpec good = testing::SmallModel().features;
  EXPECT_TRUE(Validate(good, false).ok());
  using Spoil = void (*)(FeatureSpec&);
  const Spoil spoils[] = {
      [](FeatureSpec& s) { s.features.clear(); },
      [](FeatureSpec& s) { s.features[1] = s.features[0]; },
      [](FeatureSpec& s) { s.log_offset.pop_back(); },
      [](FeatureSpec& s) { s.log_offset[0] = -1; },
      [](FeatureSpec& s) { s.hmm_scaling[0].gain = 0; },
      [](FeatureSpec& s) { s.hmm_scaling[0].offset = std::nan(""); },
      [](FeatureSpec& s) { s.lstm_scaling = s.hmm_scaling; },
      [](FeatureSpec& s) { s.sample_rate_hz = 0; },
  };
  for (size_t i = 0; i < std::size(spoils); ++i) {
    FeatureSpec spec = good;
    spoils[i](spec);
    EXPECT_EQ(ReasonOf(Validate(spec, false)), "INVALID_MODEL") << i;
  }
}

}  // namespace
}  // namespace tactus
