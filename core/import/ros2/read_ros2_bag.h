// File: read_ros2_bag.h
//
// Taxel frames from a bag of ROS 2: the messages of one topic, and poses on
// another.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const ArrayFile file,
//       ReadRos2Bag("run1", {.frames = "/tactile", .pose = "/arm/pose"}));
//   file.header;  // "time", "x" ... "qw", then one name per number
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/files/array_file.h"

namespace tactus::internal {

struct Ros2Topics {
  // With a message per frame.
  std::string frames = {};
  // The field of a message that has the taxels (ros2_taxels.h); empty: as the
  // type has it.
  std::string values = {};
  // Messages like geometry_msgs/PoseStamped; empty for none. A frame gets the
  // last pose before it, or the first one.
  std::string pose = {};
};

// Times are those at which the recorder received the messages, from the first
// frame on. IO, DATA_LOST or TRIAL_FILE_INVALID, with the file and the topic.
absl::StatusOr<ArrayFile> ReadRos2Bag(const std::string& path,
                                      const Ros2Topics& topics);

}  // namespace tactus::internal
