// File: page_json.h
//
// Messages of servers as JSON of protobuf, with the names of the .proto files,
// and errors as {"code", "reason", "message", "metadata"}.
//
//   TACTUS_ASSIGN_OR_RETURN(const grpc::ByteBuffer request,
//                           RequestFromJson(method, body));
//   TACTUS_ASSIGN_OR_RETURN(const std::string json,
//                           JsonOfReply(method, messages));
//   Response response = ErrorOfCall(status);
//
// By the descriptors that are in the program, so no method has code of its own.
// A request is INVALID_CONFIG if it has a field that the message has not, a
// value of another type, bytes that are no UTF-8, or more than 32 levels; what
// it may cost is a small multiple of limits::kMaxPageCallBytes. Thread-safe:
// free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "grpcpp/support/byte_buffer.h"
#include "tools/console/page_methods.h"
#include "tools/console/responses.h"

namespace tactus::internal::console {

absl::StatusOr<grpc::ByteBuffer> RequestFromJson(const PageMethod& method,
                                                 const std::string& json);

// INVALID_RESPONSE if the messages are not those of the method, or too many.
absl::StatusOr<std::string> JsonOfReply(
    const PageMethod& method, const std::vector<grpc::ByteBuffer>& messages);

// With the HTTP status that says the same.
Response ErrorOfCall(const absl::Status& status);

}  // namespace tactus::internal::console
