// File: request_limits.h
//
// How large a message to the services for data, jobs and models may be. It is
// compared with the bytes before they are parsed.
//
//   const size_t limit = MaxRequestBytes(*v1::TrainModelRequest::descriptor());
//   if (size > limit) return MessageTooLarge(size, limit);
//
// Thread-safe: a free function without state.
#pragma once

#include <cstddef>

#include "google/protobuf/descriptor.h"

namespace tactus::internal::server {

size_t MaxRequestBytes(const google::protobuf::Descriptor& type);

}  // namespace tactus::internal::server
