// File: fake_arm.h
//
// FakeArm: an arm of one joint that slides along x and one endless joint that
// turns about z, whose pose follows from its values at a glance. Test-only.
//
//   JointPoses poses(FakeArm());
#pragma once

#include <cmath>
#include <memory>
#include <span>

#include "client/kinematics/arm_model.h"

namespace tactus::internal::client {

class FakeChain : public ArmChain {
 public:
  Pose PoseOf(std::span<const double> values) override {
    return {.position = {values[0], 0, 0},
            .orientation = Eigen::Quaterniond(
                Eigen::AngleAxisd(values[1], Eigen::Vector3d::UnitZ()))};
  }
};

inline ArmModel FakeArm() {
  return ArmModel({{.name = "slide", .slides = true, .lower = -2, .upper = 2},
                   {.name = "turn", .endless = true}},
                  std::make_unique<FakeChain>());
}

// The angle of the second joint, -pi to pi.
inline double TurnOf(const Pose& pose) {
  return 2 * std::atan2(pose.orientation.z(), pose.orientation.w());
}

}  // namespace tactus::internal::client
