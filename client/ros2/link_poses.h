// File: link_poses.h
//
// LinkPoses: where the skin's link is when a frame is read, from messages of
// ROS 2: sensor_msgs/JointState and a URDF, or geometry_msgs/PoseStamped.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto poses,
//       LinkPoses::FromJoints(urdf_text, "forearm_skin", {}));
//   TACTUS_RETURN_IF_ERROR(poses->Take(message));
//   const std::optional<LinkPose> pose = poses->PoseAt(time_ns);
//   if (pose) Use(*pose);
//
// Times are header.stamp, or when a message was published if that is zero, as
// for frames (skin_topic.h). A joint that a message does not name keeps its
// value. Joint values are interpolated, and continued for max_age_ns after the
// newest; a pose holds until the next one, and for max_age_ns after the newest.
// Otherwise there is no pose: none is invented. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/ros2/dds_node.h"
#include "tactus/skin.h"

namespace tactus::internal::client {

struct LinkPosesOptions {
  // At 30 messages per second, one may be lost.
  int64_t max_age_ns = 70'000'000;
};

class LinkPoses {
 public:
  // `urdf`: the text of the file. The errors of ArmModel::FromUrdf.
  static absl::StatusOr<std::unique_ptr<LinkPoses>> FromJoints(
      const std::string& urdf, const std::string& skin_link,
      const LinkPosesOptions& options);
  static std::unique_ptr<LinkPoses> FromPoses(const LinkPosesOptions& options);
  virtual ~LinkPoses() = default;

  // What Take takes: "sensor_msgs/msg/JointState".
  virtual std::string type() const = 0;
  // TRIAL_FILE_INVALID for bytes that are no such message, INVALID_CONFIG for
  // values that are none; the next message may be good.
  virtual absl::Status Take(const DdsMessage& message) = 0;
  virtual std::optional<LinkPose> PoseAt(int64_t time_ns) = 0;
  // Why the last PoseAt returned nothing; empty if it returned a pose.
  virtual std::string Problem() const = 0;
};

}  // namespace tactus::internal::client
