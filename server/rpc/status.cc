#include "server/rpc/status.h"

#include <string>

#include "core/base/status_proto.h"

namespace tactus::internal::server {

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  // Both enumerations number the canonical codes alike.
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()),
                      std::string(status.message()),
                      ToStatusProto(status).SerializeAsString());
}

}  // namespace tactus::internal::server
