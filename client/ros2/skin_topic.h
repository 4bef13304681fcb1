// File: skin_topic.h
//
// SkinTopic: messages of a skin's topic as frames, by the skin.json with which
// `trainctl import` reads bags of the same topic. The frames have the same
// bits.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       SkinTopic topic,
//       SkinTopic::Make(skin_file, "std_msgs/msg/UInt16MultiArray", ""));
//   Frame frame;
//   TACTUS_ASSIGN_OR_RETURN(const bool made, topic.Read(message, frame));
//   if (made) Push(frame);
//
// Owns what it needs. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/ros2/dds_node.h"
#include "core/import/ros2/ros2_type.h"
#include "core/import/skin_file.h"
#include "tactus/skin.h"

namespace tactus::internal::client {

// The skin that streams get. INVALID_CONFIG if the file leaves thresholds to
// idle frames, which are known at the end of an import only, or has events or
// two planes.
absl::StatusOr<Skin> SkinOf(const SkinFile& file, bool with_poses);

class SkinTopic {
 public:
  // `definition` as for Ros2Type::Parse.
  static absl::StatusOr<SkinTopic> Make(SkinFile file, const std::string& type,
                                        absl::string_view definition);

  // False as long as the baseline is being taken from the first idle frames.
  // Writes the values and the time: header.stamp if the type has one that is
  // set, else when the message was published. TRIAL_FILE_INVALID for a message
  // that is no frame; the next one may be.
  absl::StatusOr<bool> Read(const DdsMessage& message, Frame& frame);

  // Idle frames that are still to come.
  int idle_frames_left() const { return idle_left_; }

 private:
  SkinTopic(SkinFile file, std::string type, Ros2Type reader);

  SkinFile file_;
  std::string type_;
  Ros2Type reader_;
  // Names of the columns of a frame: "time", then a taxel each.
  std::vector<std::string> header_;
  bool needs_idle_ = false;
  int idle_left_ = 0;
  // One for each number of a frame.
  std::vector<double> idle_sums_;
};

// header.stamp in nanoseconds; nothing if the message has none, or zero.
std::optional<int64_t> StampOf(const Ros2Message& message);

}  // namespace tactus::internal::client
