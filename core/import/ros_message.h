// File: ros_message.h
//
// RosMessageType: reads the numbers of ROS 1 messages of any type, by the
// definition that each bag holds of its messages.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto type, RosMessageType::Parse(text));
//   TACTUS_ASSIGN_OR_RETURN(const RosNumbers numbers, type.Read(bytes));
//   numbers.at("values_z");  // one per taxel
//
// Needs no ROS. Owns its fields; immutable, so thread-safe.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// The numbers of each field, by its path: "pose.position.x". Those of an array
// stand one after another, also those of a field of an array of messages. Times
// and durations are seconds; texts are left out.
using RosNumbers = std::map<std::string, std::vector<double>>;

class RosMessageType {
 public:
  // `definition`: lines "type name", then the types that they use, each after a
  // line of "=" and a line "MSG: package/Type". TRIAL_FILE_INVALID.
  static absl::StatusOr<RosMessageType> Parse(absl::string_view definition);

  // Fields without a number in `bytes` have an empty entry.
  // TRIAL_FILE_INVALID if `bytes` are not one message of this type.
  absl::StatusOr<RosNumbers> Read(absl::string_view bytes) const;

 private:
  struct Field {
    std::string type;
    std::string name;
    bool is_array = false;
    // Length of an array; -1 if each message states it.
    int count = -1;
  };
  class Reader;

  // The name of the type in types_; empty if it is not there.
  std::string Resolve(const std::string& type) const;

  // By "package/Type"; the message itself is "".
  std::map<std::string, std::vector<Field>> types_;
};

}  // namespace tactus::internal
