// File: request_parser.h
//
// Parses request messages into one that is used again: frames after frames
// allocate nothing, where protobuf's own parsing gives the memory of a oneof
// back and takes it anew each time.
//
//   if (!ParseRequest(&bytes, &request)) return MalformedRequest(size);
//
// The result is what ParseFromZeroCopyStream would give. A free function
// without state.
#pragma once

#include "google/protobuf/io/zero_copy_stream.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::server {

// False if the bytes are no request; `request` holds anything then.
bool ParseRequest(google::protobuf::io::ZeroCopyInputStream* bytes,
                  v1::ClassifyContactRequest* request);

}  // namespace tactus::server
