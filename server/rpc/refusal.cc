#include "server/rpc/refusal.h"

#include "core/base/errors.h"
#include "server/rpc/status.h"

namespace tactus::server {
namespace {

class Refusal : public BytesReactor {
 public:
  explicit Refusal(const absl::Status& status) { Finish(ToGrpcStatus(status)); }
  void OnDone() override { delete this; }
};

}  // namespace

BytesReactor* RefuseStream(const absl::Status& status) {
  return new Refusal(status);
}

grpc::ServerGenericBidiReactor* UnimplementedService::CreateReactor(
    grpc::GenericCallbackServerContext* context) {
  return new Refusal(Unimplemented(context->method()));
}

}  // namespace tactus::server
