// File: urdf_text.h
//
// CheckUrdfText: bounds what a URDF can cost before urdfdom and TinyXML, which
// bound nothing, read it. They recurse for each level of nesting and for each
// joint of a chain, so both are limited, as is the size.
//
//   TACTUS_RETURN_IF_ERROR(CheckUrdfText(urdf));
//
// It does not find out whether the text is a URDF. Thread-safe: a free function
// without state.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

// INVALID_CONFIG if the text exceeds limits::kMaxUrdfBytes, kMaxUrdfDepth or
// kMaxUrdfJoints, or holds a byte 0.
absl::Status CheckUrdfText(absl::string_view urdf);

}  // namespace tactus::internal::client
