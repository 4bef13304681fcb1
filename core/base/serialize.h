// File: serialize.h
//
// Protobuf messages as bytes that depend on their contents alone: map entries
// are written in order of their keys. Equal messages give equal bytes.
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "google/protobuf/message_lite.h"

namespace tactus {

std::string SerializeDeterministic(
    const google::protobuf::MessageLite& message);

}  // namespace tactus
