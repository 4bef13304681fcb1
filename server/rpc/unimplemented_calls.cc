#include "server/rpc/unimplemented_calls.h"

#include "core/base/errors.h"
#include "server/rpc/status.h"

namespace tactus::server {
namespace {

// Deletes itself when it was answered.
class UnimplementedCall {
 public:
  UnimplementedCall(grpc::AsyncGenericService* service, CallQueue* queue)
      : service_(service), queue_(queue) {
    queue_->Enter();
    service_->RequestCall(&context_, &stream_, queue_->queue(), queue_->queue(),
                          called_.tag());
  }

 private:
  using Event = MemberEvent<UnimplementedCall>;

  ~UnimplementedCall() { queue_->Leave(); }

  void OnCalled(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    new UnimplementedCall(service_, queue_);
    stream_.Finish(ToGrpcStatus(Unimplemented(context_.method())),
                   finished_.tag());
  }
  void OnFinished(bool) { delete this; }

  grpc::AsyncGenericService* const service_;
  CallQueue* const queue_;
  grpc::GenericServerContext context_;
  grpc::GenericServerAsyncReaderWriter stream_{&context_};
  Event called_{this, &UnimplementedCall::OnCalled};
  Event finished_{this, &UnimplementedCall::OnFinished};
};

}  // namespace

void UnimplementedCalls::Serve(CallQueue* queue) {
  new UnimplementedCall(&service_, queue);
}

}  // namespace tactus::server
