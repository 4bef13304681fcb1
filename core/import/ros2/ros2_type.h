// File: ros2_type.h
//
// Ros2Type: reads the numbers of messages of ROS 2 by the definition of their
// type: that which a bag holds, or a built-in one.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto type,
//       Ros2Type::Parse("std_msgs/msg/Float32MultiArray", ""));
//   TACTUS_ASSIGN_OR_RETURN(const Ros2Message message, type.Read(bytes));
//   message.numbers.at("data");
//
// Needs no ROS. Owns its fields; immutable, so thread-safe.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/import/ros2/cdr_reader.h"

namespace tactus::internal {

struct Ros2Message {
  // The numbers of each field, by its path: "pose.position.x". Those of an
  // array stand one after another, also those of a field of an array of
  // messages. An empty array has an empty entry.
  std::map<std::string, std::vector<double>> numbers;
  // The last text of each field, if it is short (kMaxBagTextBytes).
  std::map<std::string, std::string> texts;
};

class Ros2Type {
 public:
  // `name`: "package/msg/Type". `definition`: the text of its .msg file, then
  // those of the types that it uses, each after a line of "=" and a line
  // "MSG: package/Type"; types that are missing, or all if it is empty, are
  // built in. TRIAL_FILE_INVALID.
  static absl::StatusOr<Ros2Type> Parse(const std::string& name,
                                        absl::string_view definition);

  // True if a type of this name needs no definition.
  static bool IsBuiltIn(const std::string& name);

  // TRIAL_FILE_INVALID if `bytes` are not one CDR message of this type.
  absl::StatusOr<Ros2Message> Read(absl::string_view bytes) const;

 private:
  struct Field {
    std::string type;
    std::string name;
    bool is_array = false;
    // Length of an array; -1 if each message states it.
    int64_t count = -1;
  };
  class Walk;

  absl::Status ParseFields(const std::string& type, absl::string_view text);
  // Adds the built-in types that fields name.
  absl::Status Complete();

  std::string name_;
  // By "package/Type".
  std::map<std::string, std::vector<Field>> types_;
};

}  // namespace tactus::internal
