// File: request_parser.h
//
// Parses request messages into one message that is reused. Protobuf's own
// parsing frees and allocates the fields of a oneof for each message; this one
// allocates nothing when frames follow frames.
//
//   if (!ParseRequest(&bytes, &request)) return MalformedRequest(size);
//
// The result equals that of ParseFromZeroCopyStream. Thread-safe: a free
// function without state.
#pragma once

#include "google/protobuf/io/zero_copy_stream.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::server {

// False if the bytes are not a request; `request` is then unspecified.
bool ParseRequest(google::protobuf::io::ZeroCopyInputStream* bytes,
                  v1::ClassifyContactRequest* request);

}  // namespace tactus::internal::server
