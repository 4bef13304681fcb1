// File: arm_model.h
//
// ArmModel: where the link that carries the skin is, from the values of the
// joints between the robot's base and that link.
//
//   TACTUS_ASSIGN_OR_RETURN(ArmModel arm,
//                           ArmModel::FromUrdf(urdf, "forearm_skin"));
//   TACTUS_ASSIGN_OR_RETURN(const Pose pose, arm.PoseOf(joint_values));
//
// The world frame is the frame of the URDF's root link. Revolute, continuous
// and prismatic joints have values, fixed joints have none, and a joint that
// mimics another one follows it. Values are radians, or metres for prismatic
// joints, in the order of joints(): from the base to the skin.
//
// Needs liburdfdom-dev and liborocos-kdl-dev when Tactus is built; without them
// FromUrdf returns an error, and a program may bring an ArmChain. Owns its
// chain; movable. Not thread-safe: KDL's joints keep their last pose.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/skin/frame.h"

namespace tactus::internal::client {

struct ArmJoint {
  std::string name = {};
  // It is prismatic: metres, not radians.
  bool slides = false;
  // It is continuous: no limits, and whole turns make no difference.
  bool endless = false;
  // Without effect if `lower` is not below `upper`.
  double lower = 0;
  double upper = 0;
};

// Forward kinematics.
class ArmChain {
 public:
  virtual ~ArmChain() = default;

  // `values` has one finite value per joint. Allocates nothing.
  virtual Pose PoseOf(std::span<const double> values) = 0;
};

class ArmModel {
 public:
  // How far a value may be beyond its joint's limits, in radians or metres:
  // encoders read a little beyond a stop. More is an error, because values in
  // degrees or in another order look like that.
  static constexpr double kLimitSlack = 0.1;

  // The joints above `skin_link` in `urdf`, the text of a URDF file.
  // INVALID_CONFIG if it is no URDF or too large (limits.h), has no such link,
  // or has no movable joint above it, or one that cannot be used: planar,
  // floating, or mimicking a joint that is not above the link.
  static absl::StatusOr<ArmModel> FromUrdf(absl::string_view urdf,
                                           const std::string& skin_link);

  ArmModel(std::vector<ArmJoint> joints, std::unique_ptr<ArmChain> chain);

  const std::vector<ArmJoint>& joints() const { return joints_; }
  // "shoulder, elbow, wrist".
  std::string JointNames() const;

  // INVALID_CONFIG naming the joint unless `values` has one finite value for
  // each joint, within its limits and kLimitSlack.
  absl::Status Check(std::span<const double> values) const;
  // Check, and the pose. INVALID_CONFIG too if the link is farther than
  // limits::kMaxPositionM from the origin.
  absl::StatusOr<Pose> PoseOf(std::span<const double> values);
  // The pose without the check of limits. `values` has one finite value per
  // joint. Allocates nothing.
  Pose Forward(std::span<const double> values) {
    return chain_->PoseOf(values);
  }

  // Writes (1 - t) a + t b to `values`; t may be above 1. An endless joint goes
  // the shorter way around. All three have one value per joint.
  void Interpolate(std::span<const double> a, std::span<const double> b,
                   double t, std::span<double> values) const;

 private:
  std::vector<ArmJoint> joints_;
  std::unique_ptr<ArmChain> chain_;
};

}  // namespace tactus::internal::client
