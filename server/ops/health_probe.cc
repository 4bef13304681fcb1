#include "server/ops/health_probe.h"

#include "google/protobuf/wrappers.pb.h"
#include "grpcpp/client_context.h"
#include "grpcpp/impl/client_unary_call.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/impl/rpc_method.h"

namespace tactus::server {
namespace {

// grpc.health.v1 is not installed as a proto. Its messages hold one field,
// number 1, a string and an enum: on the wire they are these wrappers.
using HealthCheckRequest = google::protobuf::StringValue;
using HealthCheckResponse = google::protobuf::Int32Value;
constexpr int kServing = 1;

}  // namespace

absl::StatusOr<bool> ProbeHealth(grpc::Channel& channel,
                                 const std::string& service,
                                 std::chrono::milliseconds timeout) {
  const grpc::internal::RpcMethod method(
      "/grpc.health.v1.Health/Check",
      grpc::internal::RpcMethod::RpcType::NORMAL_RPC);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + timeout);
  HealthCheckRequest request;
  request.set_value(service);
  HealthCheckResponse response;
  const grpc::Status status =
      grpc::internal::BlockingUnaryCall<HealthCheckRequest, HealthCheckResponse,
                                        google::protobuf::MessageLite,
                                        google::protobuf::MessageLite>(
          &channel, method, &context, request, &response);
  if (!status.ok()) {
    return absl::Status(static_cast<absl::StatusCode>(status.error_code()),
                        status.error_message());
  }
  return response.value() == kServing;
}

}  // namespace tactus::server
