#include <cmath>
#include <map>

#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

// The paper's row: 544 / 365 / 496 / 430.
TEST(PaperSetTest, ClassCountsAreThePapersWithinThree) {
  std::map<std::string, int> counts;
  for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
    const auto contacts = SimulateWithTwin(spec);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    for (const SimulatedContact& contact : *contacts) {
      ++counts[contact.Label()];
      EXPECT_EQ(contact.signals.samples.size(), 500);
      for (const FeatureVector& sample : contact.signals.samples) {
        for (double value : sample) EXPECT_TRUE(std::isfinite(value));
      }
    }
  }
  EXPECT_EQ(counts["HU"], 544);
  EXPECT_NEAR(counts["HM"], 365, 3);
  EXPECT_EQ(counts["SU"], 496);
  EXPECT_NEAR(counts["SM"], 430, 3);
}

}  // namespace
}  // namespace tactus
