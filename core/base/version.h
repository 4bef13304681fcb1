// File: version.h
//
// The release this program was built from, as CMakeLists.txt names it.
#pragma once

namespace tactus {

inline constexpr char kVersion[] = TACTUS_VERSION;

}  // namespace tactus
