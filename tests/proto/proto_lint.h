// File: proto_lint.h
//
// House rules of the wire contract, after the STANDARD and COMMENTS groups of
// the buf linter. Test-only.
//
//   for (const std::string& complaint : Lint(file)) { ... }
#pragma once

#include <string>
#include <vector>

#include "google/protobuf/descriptor.pb.h"

namespace tactus::internal {

// Everything wrong with one file, as "place: what". The file must have been
// made with its source information, which holds the comments.
std::vector<std::string> Lint(
    const google::protobuf::FileDescriptorProto& file);

// RPCs of several files that share a request or response type.
std::vector<std::string> SharedMessages(
    const google::protobuf::FileDescriptorSet& files);

}  // namespace tactus::internal
