// File: serialize.h
//
// Serialises protobuf messages so that equal messages give equal bytes: map
// entries are written in the order of their keys.
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "google/protobuf/message_lite.h"

namespace tactus {

std::string SerializeDeterministic(
    const google::protobuf::MessageLite& message);

}  // namespace tactus
