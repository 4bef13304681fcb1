// File: message_schema.h
//
// The schema of a protobuf message for an MCAP file: its FileDescriptorSet, so
// that other programs decode the messages without our sources.
//
//   const McapSchema schema = MessageSchema(*v1::Answer::descriptor());
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "core/files/mcap/mcap_records.h"
#include "google/protobuf/descriptor.h"

namespace tactus::internal {

McapSchema MessageSchema(const google::protobuf::Descriptor& message);

// The schema of JSON objects of any kind.
McapSchema JsonSchema(const std::string& name);

}  // namespace tactus::internal
