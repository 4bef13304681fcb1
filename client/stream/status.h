// File: status.h
//
// Errors as they come back from a server: a grpc::Status with a
// tactus.v1.Status in its details becomes the absl::Status the server raised,
// so that ReasonOf() works on it. Thread-safe.
#pragma once

#include "absl/status/status.h"
#include "grpcpp/support/status.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal::client {

absl::Status FromGrpcStatus(const grpc::Status& status);

// The same for a status inside a message.
absl::Status FromStatusProto(const v1::Status& status);

// True if the call broke on its way, or the server asks to come again: the
// same call may succeed later. False for every answer of the server itself.
bool MayRetry(const absl::Status& status);

}  // namespace tactus::internal::client
