// File: status.h
//
// Errors on their way to the client: the ErrorInfo of an absl::Status becomes
// the one detail of a tactus.v1.Status in the grpc-status-details-bin trailer,
// where standard tools look for it. Thread-safe.
#pragma once

#include "absl/status/status.h"
#include "grpcpp/support/status.h"

namespace tactus::internal::server {

grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace tactus::internal::server
