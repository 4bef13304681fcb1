#include "client/stream/status.h"

#include <string>

#include "absl/strings/cord.h"
#include "core/base/errors.h"

namespace tactus::internal::client {

absl::Status FromStatusProto(const v1::Status& status) {
  absl::Status result(static_cast<absl::StatusCode>(status.code()),
                      status.message());
  for (const google::protobuf::Any& detail : status.details()) {
    result.SetPayload(detail.type_url(), absl::Cord(detail.value()));
  }
  return result;
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  v1::Status details;
  // Anything else than a Status leaves no details.
  if (!details.ParseFromString(status.error_details())) details.Clear();
  // All enumerations number the canonical codes alike.
  details.set_code(status.error_code());
  details.set_message(status.error_message());
  return FromStatusProto(details);
}

bool MayRetry(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
      return true;
    case absl::StatusCode::kAborted:
      return reason == "UPLOAD_BUSY";
    case absl::StatusCode::kDeadlineExceeded:
      return reason.empty() || reason == "NO_RESPONSE";
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
      // gRPC reports broken connections and streams with these.
      return reason.empty();
    default:
      return false;
  }
}

}  // namespace tactus::internal::client
