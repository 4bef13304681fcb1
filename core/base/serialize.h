// File: serialize.h
//
// Serialises protobuf messages so that equal messages give equal bytes: map
// entries are written in the order of their keys. Checksums and golden files
// need this.
//
//   const std::string payload = SerializeDeterministic(bundle);
//   EXPECT_EQ(payload, SerializeDeterministic(ModelToProto(model)));
//
// The default serialisation may order map entries differently in each process.
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "google/protobuf/message_lite.h"

namespace tactus::internal {

// Returns the bytes of `message`.
std::string SerializeDeterministic(
    const google::protobuf::MessageLite& message);

}  // namespace tactus::internal
