#include "server/rpc/health_service.h"

#include "absl/strings/str_cat.h"
#include "grpcpp/server_context.h"
#include "grpcpp/support/async_stream.h"

namespace tactus::server {

using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

// One Watch call; deletes itself when its caller is gone.
class HealthWatch {
 public:
  HealthWatch(HealthService* service, CallQueue* queue)
      : service_(service), queue_(queue) {
    queue_->Enter();
    // Its event comes only for a call that begins.
    context_.AsyncNotifyWhenDone(ended_.tag());
    service_->RequestWatch(&context_, &request_, &writer_, queue_->queue(),
                           queue_->queue(), called_.tag());
  }

  // Tells the status, if it is another than was told last.
  void Update() {
    if (over_ || writing_) return;
    const HealthService::Status status = service_->status(request_.service());
    if (status == told_) return;
    told_ = status;
    HealthCheckResponse response;
    response.set_status(status);
    writing_ = true;
    ++in_flight_;
    writer_.Write(response, written_.tag());
  }

 private:
  using Event = MemberEvent<HealthWatch>;

  ~HealthWatch() { queue_->Leave(); }

  void OnCalled(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    new HealthWatch(service_, queue_);
    // That the call ended is still to come.
    in_flight_ = 1;
    service_->watches_.at(queue_).insert(this);
    Update();
  }
  void OnWritten(bool ok) {
    --in_flight_;
    writing_ = false;
    if (ok) Update();
    Advance();
  }
  void OnEnded(bool) {
    over_ = true;
    service_->watches_.at(queue_).erase(this);
    // In flight in place of this event.
    writer_.Finish(grpc::Status::CANCELLED, finished_.tag());
  }
  void OnFinished(bool) {
    --in_flight_;
    Advance();
  }
  void Advance() {
    if (over_ && in_flight_ == 0) delete this;
  }

  HealthService* const service_;
  CallQueue* const queue_;
  grpc::ServerContext context_;
  HealthCheckRequest request_;
  grpc::ServerAsyncWriter<HealthCheckResponse> writer_{&context_};
  Event called_{this, &HealthWatch::OnCalled};
  Event written_{this, &HealthWatch::OnWritten};
  Event ended_{this, &HealthWatch::OnEnded};
  Event finished_{this, &HealthWatch::OnFinished};
  int in_flight_ = 0;
  bool writing_ = false;
  bool over_ = false;
  HealthService::Status told_ = HealthCheckResponse::UNKNOWN;
};

void HealthService::Serve(CallQueue* queue) {
  watches_.try_emplace(queue);
  new HealthWatch(this, queue);
}

void HealthService::SetServing(const std::string& service, bool serving) {
  {
    const std::lock_guard lock(mutex_);
    statuses_[service] = serving ? HealthCheckResponse::SERVING
                                 : HealthCheckResponse::NOT_SERVING;
  }
  for (auto& [queue, watches] : watches_) {
    queue->Post([&watches = watches] {
      for (HealthWatch* watch : watches) watch->Update();
    });
  }
}

HealthService::Status HealthService::status(const std::string& service) const {
  const std::lock_guard lock(mutex_);
  const auto found = statuses_.find(service);
  return found == statuses_.end() ? HealthCheckResponse::SERVICE_UNKNOWN
                                  : found->second;
}

grpc::Status HealthService::Check(grpc::ServerContext*,
                                  const HealthCheckRequest* request,
                                  HealthCheckResponse* response) {
  const Status found = status(request->service());
  if (found == HealthCheckResponse::SERVICE_UNKNOWN) {
    return {grpc::StatusCode::NOT_FOUND,
            absl::StrCat("no service '", request->service(), "'")};
  }
  response->set_status(found);
  return grpc::Status::OK;
}

}  // namespace tactus::server
