// File: proto_json.h
//
// Messages of the wire as JSON for scripts.
//
//   PrintJson(ToJson(operation));
//
// Keys are the names of the fields. Numbers are numbers, of 64 bits too. An
// enum is its value's name without the prefix, in lower case: "succeeded".
// Fields that can be absent are left out if they are; all others are written.
// A tactus.v1.Status is {"code", "reason", "message"}.
//
// Thread-safe: free functions without state.
#pragma once

#include "google/protobuf/message.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

Json ToJson(const google::protobuf::Message& message);

template <typename Messages>
Json ArrayToJson(const Messages& messages) {
  Json array = Json::array();
  for (const auto& message : messages) array.push_back(ToJson(message));
  return array;
}

// Prints one line to standard output.
void PrintJson(const Json& json);

// The name of an enum's value as in JSON, e.g. "succeeded".
std::string EnumText(const google::protobuf::EnumValueDescriptor& value);

}  // namespace tactus::internal::client
