// File: breaking_changes.h
//
// Tells whether programs built against an older wire contract still work with
// a newer one. Test-only.
//
//   BreakingChanges(golden, current)  // empty: nothing breaks
#pragma once

#include <string>
#include <vector>

#include "google/protobuf/descriptor.pb.h"

namespace tactus::internal {

// Everything in `before` that is gone from `after` or means something else
// there, as "place: what". Additions break nothing.
std::vector<std::string> BreakingChanges(
    const google::protobuf::FileDescriptorSet& before,
    const google::protobuf::FileDescriptorSet& after);

}  // namespace tactus::internal
