// File: status_proto.h
//
// absl::Status as the message tactus.v1.Status, and back: how errors travel on
// the wire, in operations and between processes. The ErrorInfo with its reason
// is kept.
//
//   *operation.mutable_error() = ToStatusProto(status);
//   const absl::Status same = FromStatusProto(operation.error());
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal {

v1::Status ToStatusProto(const absl::Status& status);

absl::Status FromStatusProto(const v1::Status& message);

}  // namespace tactus::internal
