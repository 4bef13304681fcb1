// File: ros_bag.h
//
// Taxel frames from bags of ROS 1: messages like hrl_haptic_manip's TaxelArray
// on one topic, and poses on another. An optional component: without Debian's
// librosbag-storage-dev at build time, every call says so.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const ArrayFile file,
//       ReadBag("run1.bag", {.frames = "/skin/taxels", .pose = "/arm/pose"}));
//   file.header;  // "time", "x" ... "qw", then one name per taxel
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/files/array_file.h"

namespace tactus::internal {

struct BagTopics {
  // With a message per frame.
  std::string frames = {};
  // What of a message is the load of the taxels: "normal", the forces values_x,
  // values_y, values_z along normals_x, normals_y, normals_z; "magnitude", the
  // length of the forces; or the path of a field with one number per taxel.
  std::string values = "normal";
  // Messages with `position` and `orientation`, perhaps within `pose`, as
  // geometry_msgs/PoseStamped; empty for none. A frame gets the last pose
  // before it, or the first one.
  std::string pose = {};
};

// Times are those at which the bag received the messages, from the first frame
// on. IO if the file cannot be read; TRIAL_FILE_INVALID names the file, the
// topic and the field; INVALID_CONFIG without the component.
absl::StatusOr<ArrayFile> ReadBag(const std::string& path,
                                  const BagTopics& topics);

}  // namespace tactus::internal
