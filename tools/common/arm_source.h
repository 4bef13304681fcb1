// File: arm_source.h
//
// ArmSource: the poses of a skin on a moving arm, as a program's flags describe
// them: a URDF file, the skin's link in it, and the address to which the
// robot's program sends joint values.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto arm,
//       ArmSource::Make({.urdf = "arm.urdf", .skin_link = "forearm_skin",
//                        .joints = "127.0.0.1:5005"}));
//   HardwareDriver driver(&device, arm->DriverOptions());
//
// Thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/drivers/hardware_driver.h"
#include "client/kinematics/joint_poses.h"
#include "client/kinematics/joint_receiver.h"

namespace tactus::internal::client {

struct ArmSourceOptions {
  // A file. Empty: frames without poses.
  std::string urdf = {};
  std::string skin_link = {};
  // host:port for datagrams (joint_line.h).
  std::string joints = {};
};

class ArmSource {
 public:
  // INVALID_CONFIG or IO. The socket is open from then on.
  static absl::StatusOr<std::unique_ptr<ArmSource>> Make(
      const ArmSourceOptions& options);

  // The source outlives the driver.
  HardwareDriverOptions DriverOptions();
  std::optional<Pose> PoseAt(int64_t time_ns) { return poses_.PoseAt(time_ns); }
  // "joint values at 127.0.0.1:5005 as: time_ns shoulder elbow wrist".
  std::string Usage() const;
  // "joint samples: 1200 taken, 3 refused, the last: ...".
  std::string Summary() const;
  int port() const { return receiver_->port(); }

 private:
  ArmSource(ArmModel arm, std::string address)
      : poses_(std::move(arm)), address_(std::move(address)) {}

  std::string Problem() const;

  JointPoses poses_;
  const std::string address_;
  std::unique_ptr<JointReceiver> receiver_;
};

}  // namespace tactus::internal::client
