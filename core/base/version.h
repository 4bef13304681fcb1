// File: version.h
//
// The release that this program was built from, as CMakeLists.txt names it. It
// is a separate header so that a new release recompiles only its few users.
#pragma once

namespace tactus::internal {

inline constexpr char kVersion[] = TACTUS_VERSION;

}  // namespace tactus::internal
