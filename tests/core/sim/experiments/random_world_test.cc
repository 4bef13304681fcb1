#include "core/sim/experiments/random_world.h"

#include <cmath>
#include <map>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0;
  double mean_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / a.size();
    mean_b += b[i] / b.size();
  }
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

// What decides the class (stiffness, mass, friction, fixed) tells nothing
// about anything else that is drawn.
TEST(RandomWorldTest, NothingButPhysicsIsCorrelatedWithTheObject) {
  const SkinModel skin = *SkinModelNamed("good");
  std::map<std::string, std::vector<double>> drawn;
  Random random(0);
  for (uint64_t n = 0; n < 4000; ++n) {
    const auto [spec, placement] =
        DrawWorldContact(skin, /*seed=*/7, n, random);
    const Material& material = spec.object.material;
    drawn["modulus"].push_back(std::log(material.youngs_modulus));
    drawn["density"].push_back(std::log(material.density));
    drawn["friction"].push_back(material.wood.mu_static);
    drawn["sliding"].push_back(material.wood.mu_kinetic /
                               material.wood.mu_static);
    drawn["poisson"].push_back(material.poisson_ratio);
    drawn["edge"].push_back(spec.object.edge_m);
    drawn["fixed"].push_back(spec.fixed);
    drawn["arm"].push_back(std::log(spec.robot.stiffness));
    drawn["speed"].push_back(std::log(spec.robot.velocity));
    drawn["goal"].push_back(std::log(spec.robot.goal_m));
    drawn["approach"].push_back(spec.approach_s);
    drawn["row"].push_back(placement.centre.row);
    drawn["column"].push_back(placement.centre.column);
    drawn["tilt"].push_back(placement.tilt_rad);
    drawn["pose noise"].push_back(std::log(placement.pose_noise_m));
    drawn["pose gain"].push_back(placement.pose_gain_error);
  }
  for (const auto& [name, values] : drawn) {
    for (const auto& [other, others] : drawn) {
      // Four standard deviations of the correlation of 4,000 pairs.
      if (name < other) {
        EXPECT_LT(std::abs(Correlation(values, others)), 0.064)
            << name << " and " << other;
      }
    }
  }
}

TEST(RandomWorldTest, AContactDependsOnSeedAndNumberAlone) {
  const SkinModel skin = *SkinModelNamed("measured");
  const auto first = WorldTrial(skin, 3, 17);
  ASSERT_TRUE(WorldTrial(skin, 3, 18).ok());
  const auto again = WorldTrial(skin, 3, 17);
  ASSERT_TRUE(first.ok() && again.ok());
  EXPECT_EQ(first->taxels.u16, again->taxels.u16);
  EXPECT_EQ(first->condition, again->condition);
  EXPECT_NE(first->taxels.u16, WorldTrial(skin, 4, 17)->taxels.u16);
}

TEST(RandomWorldTest, AllCategoriesOccurAndTrialsAreValid) {
  const SkinModel skin = *SkinModelNamed("good");
  std::map<std::string, int> labels;
  for (uint64_t n = 0; n < 60; ++n) {
    const auto trial = WorldTrial(skin, 1, n);
    ASSERT_TRUE(trial.ok()) << trial.status();
    ASSERT_TRUE(Validate(*trial, "here").ok());
    ++labels[trial->label];
  }
  for (const char* const label : {"HU", "HM", "SU", "SM"}) {
    EXPECT_GE(labels[label], 4) << label;
  }
}

}  // namespace
}  // namespace tactus::internal
