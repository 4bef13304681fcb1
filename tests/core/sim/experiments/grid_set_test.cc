#include "core/sim/experiments/grid_set.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/sim/experiments/paper_set.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(GridTest, HasNoConditionOfThePaper) {
  const auto conditions = UntrainedGrid().Conditions();
  ASSERT_EQ(conditions.size(), 48u);
  std::set<std::string> names;
  for (const RobotCondition& robot : conditions) {
    names.insert(ConditionName(robot));
    EXPECT_NE(robot.stiffness, 543);
    EXPECT_NE(robot.stiffness, 2050);
    EXPECT_NE(robot.velocity, 0.005);
    EXPECT_NE(robot.velocity, 0.02);
    EXPECT_NE(robot.goal_m, 0.019);
    EXPECT_GE(robot.stiffness, 250);
    EXPECT_LE(robot.stiffness, 4000);
    EXPECT_GE(robot.velocity, 0.0025);
    EXPECT_LE(robot.velocity, 0.04);
    EXPECT_GE(robot.goal_m, 0.01);
    EXPECT_LE(robot.goal_m, 0.04);
  }
  EXPECT_EQ(names.size(), 48u);
  EXPECT_EQ(ConditionName({630, 0.016, 0.02}), "k630-v0.016-g0.02");
}

TEST(DrawSpecsTest, IsEvenOverConditionsFromTheStart) {
  const RobotGrid grid = {{250, 4000}, {0.04}, {0.01, 0.02}};
  const auto robots = grid.Conditions();
  const auto specs = DrawSpecs(robots, 1);
  ASSERT_EQ(specs.size(), 4u * 260);
  std::map<std::string, int> seen;
  for (int i = 0; i < 40; ++i) ++seen[ConditionName(specs[i].robot)];
  ASSERT_EQ(seen.size(), 4u);
  for (const auto& [name, count] : seen) EXPECT_EQ(count, 10) << name;
}

TEST(DrawSpecsTest, DrawsEachContactOnce) {
  const auto robots = PaperGrid().Conditions();
  const auto all = TrialSpecs(robots);
  const auto specs = DrawSpecs(robots, 1);
  ASSERT_EQ(specs.size(), all.size());
  std::set<uint64_t> numbers;
  for (const TrialSpec& spec : specs) {
    numbers.insert(spec.number);
    const TrialSpec& same = all[spec.number / 2];
    EXPECT_EQ(same.number, spec.number);
    EXPECT_EQ(same.object.material.name, spec.object.material.name);
    EXPECT_EQ(same.robot.stiffness, spec.robot.stiffness);
  }
  EXPECT_EQ(numbers.size(), all.size());
}

TEST(DrawSpecsTest, FollowsTheSeed) {
  const auto robots = PaperGrid().Conditions();
  const auto numbers = [&](uint64_t seed) {
    std::vector<uint64_t> drawn;
    for (const TrialSpec& spec : DrawSpecs(robots, seed)) {
      drawn.push_back(spec.number);
    }
    return drawn;
  };
  EXPECT_EQ(numbers(1), numbers(1));
  EXPECT_NE(numbers(1), numbers(2));
  EXPECT_TRUE(DrawSpecs({}, 1).empty());
}

}  // namespace
}  // namespace tactus::internal
