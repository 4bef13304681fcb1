#include "core/sim/experiments/grid_set.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/random.h"

namespace tactus::internal {
namespace {

// Apart from the streams of the trials' noise.
constexpr uint64_t kDrawStream = uint64_t{1} << 34;

}  // namespace

RobotGrid UntrainedGrid() {
  return {.stiffnesses = {250, 630, 1600, 4000},
          .velocities = {0.0025, 0.0063, 0.016, 0.04},
          .goals = {0.01, 0.02, 0.04}};
}

std::vector<TrialSpec> DrawSpecs(const std::vector<RobotCondition>& robots,
                                 uint64_t seed,
                                 std::span<const Material> materials) {
  std::vector<TrialSpec> specs = TrialSpecs(robots, materials);
  if (robots.empty()) return specs;
  const size_t objects = specs.size() / robots.size();
  // Shuffles the objects of each condition (Fisher and Yates).
  for (size_t condition = 0; condition < robots.size(); ++condition) {
    Random random = Random::ForStream(seed, kDrawStream + condition);
    TrialSpec* own = &specs[condition * objects];
    for (size_t left = objects; left > 1; --left) {
      std::swap(own[left - 1], own[random.Index(left)]);
    }
  }
  std::vector<TrialSpec> drawn;
  drawn.reserve(specs.size());
  for (size_t round = 0; round < objects; ++round) {
    for (size_t condition = 0; condition < robots.size(); ++condition) {
      drawn.push_back(specs[condition * objects + round]);
    }
  }
  return drawn;
}

std::string ConditionName(const RobotCondition& robot) {
  return absl::StrCat("k", robot.stiffness, "-v", robot.velocity, "-g",
                      robot.goal_m);
}

}  // namespace tactus::internal
