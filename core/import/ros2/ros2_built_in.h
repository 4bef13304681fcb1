// File: ros2_built_in.h
//
// Definitions of common types of ROS 2, for bags that hold none: those of
// SQLite before Iron, and of recorders that did not find them.
//
//   BuiltInRos2Type("std_msgs/Header");
//   // "builtin_interfaces/Time stamp\nstring frame_id"
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// The fields of the type "package/Type"; null data for one that is not known.
absl::string_view BuiltInRos2Type(const std::string& name);

}  // namespace tactus::internal
