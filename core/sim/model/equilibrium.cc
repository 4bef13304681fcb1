#include "core/sim/model/equilibrium.h"

#include <algorithm>
#include <limits>

namespace tactus::internal {

std::vector<EquilibriumLeg> EquilibriumLegs(const ContactScene& scene) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double turn = scene.retreat_after_s;
  std::vector<EquilibriumLeg> legs = {
      {scene.lead_m, scene.velocity_m_s, std::min(scene.RampEnd(), turn)}};
  if (scene.RampEnd() < turn) legs.push_back({scene.goal_m, 0, turn});
  if (turn == kNever) return legs;
  const double speed = -scene.retreat_speed_m_s;
  legs.push_back({legs.back().PositionAt(turn) - speed * turn, speed, kNever});
  return legs;
}

}  // namespace tactus::internal
