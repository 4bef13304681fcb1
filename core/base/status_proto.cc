#include "core/base/status_proto.h"

#include <string>

#include "absl/strings/cord.h"

namespace tactus::internal {

v1::Status ToStatusProto(const absl::Status& status) {
  v1::Status message;
  message.set_code(static_cast<int>(status.code()));
  message.set_message(std::string(status.message()));
  status.ForEachPayload(
      [&](absl::string_view type_url, const absl::Cord& value) {
        google::protobuf::Any* detail = message.add_details();
        detail->set_type_url(std::string(type_url));
        detail->set_value(std::string(value));
      });
  return message;
}

absl::Status FromStatusProto(const v1::Status& message) {
  absl::Status status(static_cast<absl::StatusCode>(message.code()),
                      message.message());
  for (const google::protobuf::Any& detail : message.details()) {
    status.SetPayload(detail.type_url(), absl::Cord(detail.value()));
  }
  return status;
}

}  // namespace tactus::internal
