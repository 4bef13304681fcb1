#include "server/rpc/status.h"

#include <string>

#include "absl/strings/cord.h"
#include "tactus/v1/common.pb.h"

namespace tactus::server {

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const std::string message(status.message());
  v1::Status details;
  details.set_code(static_cast<int>(status.code()));
  details.set_message(message);
  status.ForEachPayload(
      [&](absl::string_view type_url, const absl::Cord& value) {
        google::protobuf::Any* detail = details.add_details();
        detail->set_type_url(std::string(type_url));
        detail->set_value(std::string(value));
      });
  // Both enumerations number the canonical codes alike.
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), message,
                      details.SerializeAsString());
}

}  // namespace tactus::server
