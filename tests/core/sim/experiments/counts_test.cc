#include <cmath>
#include <map>

#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

double VarianceOf(const IdealSignals& signals, int feature) {
  double sum = 0;
  double squares = 0;
  for (const FeatureVector& sample : signals.samples) {
    sum += sample[feature];
    squares += sample[feature] * sample[feature];
  }
  const double mean = sum / signals.samples.size();
  return squares / signals.samples.size() - mean * mean;
}

// The paper's row: 544 / 365 / 496 / 430.
TEST(PaperSetTest, CountsAreThePapersWithinThreeAndNoiseIsTheirMean) {
  std::map<std::string, int> counts;
  FeatureVector mean_variance = {};
  for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
    const auto contacts = SimulateWithTwin(spec);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    for (const SimulatedContact& contact : *contacts) {
      ++counts[contact.Label()];
      EXPECT_EQ(contact.signals.samples.size(), 500);
      for (const FeatureVector& sample : contact.signals.samples) {
        for (double value : sample) EXPECT_TRUE(std::isfinite(value));
      }
      for (int f = 0; f < kFeatureCount; ++f) {
        mean_variance[f] += VarianceOf(contact.signals, f);
      }
    }
  }
  EXPECT_EQ(counts["HU"], 544);
  EXPECT_NEAR(counts["HM"], 365, 3);
  EXPECT_EQ(counts["SU"], 496);
  EXPECT_NEAR(counts["SM"], 430, 3);
  for (int f = 0; f < kFeatureCount; ++f) {
    mean_variance[f] /= 1835;
    EXPECT_NEAR(mean_variance[f] / kMeanVariance[f], 1, 1e-4);
  }
}

}  // namespace
}  // namespace tactus::internal
