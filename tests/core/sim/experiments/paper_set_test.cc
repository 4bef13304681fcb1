#include "core/sim/experiments/paper_set.h"

#include <set>

#include "core/base/errors.h"
#include "core/sim/exact/simulate_contact.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

TrialSpec Spec(const char* material, double edge) {
  TrialSpec spec;
  spec.object = {*FindMaterial(material), edge, Surface::kWood};
  spec.number = 4;
  return spec;
}

TEST(TrialSpecsTest, EnumeratesThePapersBaseTrials) {
  const auto specs = TrialSpecs(PaperGrid().Conditions());
  ASSERT_EQ(specs.size(), 1040);
  std::set<std::string> names;
  std::set<uint64_t> numbers;
  int hard = 0;
  for (const TrialSpec& spec : specs) {
    SimulatedContact contact;
    contact.spec = spec;
    const Trial trial = contact.Metadata();
    names.insert(trial.object + trial.condition);
    numbers.insert(spec.number);
    numbers.insert(FixedTwin(spec).number);
    hard += contact.hard();
    EXPECT_TRUE(Validate(SceneOf(spec)).ok());
  }
  EXPECT_EQ(names.size(), 1040);
  EXPECT_EQ(numbers.size(), 2080);
  // Each base trial gives one unmoved trial, so this is the paper's 544.
  EXPECT_EQ(hard, 544);
  EXPECT_NEAR(specs.back().object.edge_m, 0.2, 1e-12);
}

TEST(SimulateContactTest, LabelsAndDescribesTheTrial) {
  auto contact = SimulateContact(Spec("steel", 0.01 + 0.19 / 9));
  ASSERT_TRUE(contact.ok()) << contact.status();
  const Trial trial = SignalTrial(*contact, {}, 1);
  EXPECT_EQ(trial.id, "000004");
  EXPECT_EQ(trial.label, "HM");
  EXPECT_EQ(trial.condition, "k543-v0.005");
  EXPECT_EQ(trial.object, "steel-0.0311-wood");
  EXPECT_EQ(trial.material, "steel");
  EXPECT_NEAR(trial.stiffness, 2 * (0.01 + 0.19 / 9) * 2e11, 1);
  EXPECT_EQ(trial.velocity, 0.005);
  EXPECT_EQ(trial.unit, "newton");
  EXPECT_EQ(trial.layout, "");
  EXPECT_EQ(trial.signals.size(), 500);
  EXPECT_EQ(trial.time.size(), 500);
  EXPECT_NEAR(trial.time[499], 4.99, 1e-12);
}

// A few trials of the set; counts_test.cc counts all of them.
TEST(SimulateWithTwinTest, MovedTrialsAreFollowedByTheirFixedTwin) {
  const TrialSpec specs[] = {Spec("fat", 0.2), Spec("light-foam", 0.2),
                             Spec("steel", 0.2), Spec("ceramic", 0.0522)};
  std::vector<std::string> seen;
  for (const TrialSpec& spec : specs) {
    const auto contacts = SimulateWithTwin(spec);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    for (const SimulatedContact& contact : *contacts) {
      const Trial trial = contact.Metadata();
      seen.push_back(trial.label + " " + trial.object);
    }
  }
  EXPECT_EQ(seen,
            (std::vector<std::string>{
                "SU fat-0.2000-wood", "SM light-foam-0.2000-wood",
                "SU light-foam-0.2000-wood-fixed", "HU steel-0.2000-wood",
                "HM ceramic-0.0522-wood", "HU ceramic-0.0522-wood-fixed"}));
}

TEST(SimulateContactTest, BadRobotIsNamed) {
  TrialSpec spec = Spec("fat", 0.2);
  spec.robot.velocity = -1;
  const auto contact = SimulateContact(spec);
  EXPECT_EQ(ReasonOf(contact.status()), "INVALID_SCENE");
  EXPECT_EQ(SimulateWithTwin(spec).status(), contact.status());
  EXPECT_EQ(InfoOf(contact.status()).metadata().at("field"),
            "scene.velocity_m_s");
}

TEST(SignalTrialTest, SameSeedSameBitsOtherSeedOtherNoise) {
  const auto contact = SimulateContact(Spec("muscle", 0.1));
  const auto again = SimulateContact(Spec("muscle", 0.1));
  ASSERT_TRUE(contact.ok() && again.ok());
  EXPECT_EQ(SignalTrial(*contact, {}, 7).signals,
            SignalTrial(*again, {}, 7).signals);
  EXPECT_NE(SignalTrial(*contact, {}, 7).signals,
            SignalTrial(*contact, {}, 8).signals);
}

}  // namespace
}  // namespace tactus::internal
