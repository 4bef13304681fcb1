#include "client/stream/status.h"

#include "absl/strings/cord.h"

namespace tactus::client {

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

}  // namespace tactus::client
