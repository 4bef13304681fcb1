#include "client/kinematics/arm_model.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

bool IsNumber(double value) {
  return std::abs(value) <= limits::kMaxJointValue;
}

bool IsInLimits(const ArmJoint& joint, double value) {
  if (joint.endless || !(joint.lower < joint.upper)) return true;
  return value >= joint.lower - ArmModel::kLimitSlack &&
         value <= joint.upper + ArmModel::kLimitSlack;
}

absl::Status BadValue(const ArmJoint& joint, double value) {
  const absl::string_view unit = joint.slides ? "m" : "rad";
  const std::string want =
      IsNumber(value)
          ? absl::StrCat(joint.lower, " to ", joint.upper, " ", unit,
                         ", its limits (are the units and the order right?)")
          : absl::StrCat("a number, at most ", limits::kMaxJointValue, " ",
                         unit);
  return InvalidConfig(absl::StrCat("joint ", joint.name), value, want);
}

}  // namespace

ArmModel::ArmModel(std::vector<ArmJoint> joints,
                   std::unique_ptr<ArmChain> chain)
    : joints_(std::move(joints)), chain_(std::move(chain)) {}

std::string ArmModel::JointNames() const {
  return absl::StrJoin(joints_, ", ", [](std::string* out, const auto& joint) {
    out->append(joint.name);
  });
}

absl::Status ArmModel::Check(std::span<const double> values) const {
  if (values.size() != joints_.size()) {
    return InvalidConfig("number of joint values", values.size(),
                         absl::StrCat(joints_.size(), ": ", JointNames()));
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (!IsNumber(values[i]) || !IsInLimits(joints_[i], values[i])) {
      return BadValue(joints_[i], values[i]);
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Pose> ArmModel::PoseOf(std::span<const double> values) {
  TACTUS_RETURN_IF_ERROR(Check(values));
  const Pose pose = Forward(values);
  const double distance = pose.position.norm();
  if (distance <= limits::kMaxPositionM) return pose;
  return InvalidConfig("metres from the base to the skin", distance,
                       absl::StrCat("at most ", limits::kMaxPositionM));
}

void ArmModel::Interpolate(std::span<const double> a, std::span<const double> b,
                           double t, std::span<double> values) const {
  for (size_t i = 0; i < joints_.size(); ++i) {
    double difference = b[i] - a[i];
    if (joints_[i].endless) {
      difference = std::remainder(difference, 2 * std::numbers::pi);
    }
    values[i] = a[i] + t * difference;
  }
}

}  // namespace tactus::internal::client
