#include "server/rpc/health_service.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "grpcpp/support/async_stream.h"
#include "grpcpp/support/async_unary_call.h"
#include "server/rpc/incoming_call.h"
#include "server/rpc/status.h"

namespace tactus::internal::server {

using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

// One Check call; deletes itself when it was answered.
class HealthCheck {
 public:
  HealthCheck(HealthService* service, CallQueue* queue)
      : service_(service), call_(queue) {
    service_->RequestCheck(call_.context(), &request_, &answer_, queue->queue(),
                           queue->queue(), called_.tag());
  }

 private:
  using Event = MemberEvent<HealthCheck>;

  ~HealthCheck() = default;

  void OnCalled(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    call_.Arrive();
    new HealthCheck(service_, call_.queue());
    const HealthService::Status status = service_->status(request_.service());
    HealthCheckResponse response;
    response.set_status(status);
    if (status == HealthCheckResponse::SERVICE_UNKNOWN) {
      answer_.FinishWithError(
          {grpc::StatusCode::NOT_FOUND,
           absl::StrCat("no service '", Shortened(request_.service()), "'")},
          finished_.tag());
    } else {
      answer_.Finish(response, grpc::Status::OK, finished_.tag());
    }
  }
  void OnFinished(bool) { delete this; }

  static std::string Shortened(const std::string& name) {
    return name.substr(0, limits::kMaxNameBytes);
  }

  HealthService* const service_;
  IncomingCall call_;
  HealthCheckRequest request_;
  grpc::ServerAsyncResponseWriter<HealthCheckResponse> answer_{call_.context()};
  Event called_{this, &HealthCheck::OnCalled};
  Event finished_{this, &HealthCheck::OnFinished};
};

// One Watch call; deletes itself when its caller is gone.
class HealthWatch {
 public:
  HealthWatch(HealthService* service, CallQueue* queue)
      : service_(service), call_(queue) {
    // Its event comes only for a call that begins.
    call_.context()->AsyncNotifyWhenDone(ended_.tag());
    service_->RequestWatch(call_.context(), &request_, &writer_, queue->queue(),
                           queue->queue(), called_.tag());
  }

  // Sends the status if it differs from the one sent last.
  void Update() {
    if (over_ || writing_) return;
    const HealthService::Status status = service_->status(request_.service());
    if (status == sent_) return;
    sent_ = status;
    HealthCheckResponse response;
    response.set_status(status);
    writing_ = true;
    ++in_flight_;
    writer_.Write(response, written_.tag());
  }

 private:
  using Event = MemberEvent<HealthWatch>;

  ~HealthWatch() = default;

  void OnCalled(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    new HealthWatch(service_, call_.queue());
    // The event OnEnded is still to come.
    in_flight_ = 1;
    const absl::Status status = call_.Arrive(
        [this] { return service_->Admit(request_, call_.peer()); });
    admitted_ = status.ok();
    if (admitted_) {
      service_->watches_.at(call_.queue()).insert(this);
      Update();
    } else {
      Finish(ToGrpcStatus(status));
    }
  }
  void OnWritten(bool ok) {
    --in_flight_;
    writing_ = false;
    if (ok) Update();
    Advance();
  }
  void OnEnded(bool) {
    --in_flight_;
    over_ = true;
    if (admitted_) {
      service_->watches_.at(call_.queue()).erase(this);
      service_->watch_gate_.Leave(call_.peer(), 0);
      Finish(grpc::Status::CANCELLED);
    }
    Advance();
  }
  void Finish(const grpc::Status& status) {
    ++in_flight_;
    writer_.Finish(status, finished_.tag());
  }
  void OnFinished(bool) {
    --in_flight_;
    Advance();
  }
  void Advance() {
    if (over_ && in_flight_ == 0) delete this;
  }

  HealthService* const service_;
  IncomingCall call_;
  HealthCheckRequest request_;
  grpc::ServerAsyncWriter<HealthCheckResponse> writer_{call_.context()};
  Event called_{this, &HealthWatch::OnCalled};
  Event written_{this, &HealthWatch::OnWritten};
  Event ended_{this, &HealthWatch::OnEnded};
  Event finished_{this, &HealthWatch::OnFinished};
  int in_flight_ = 0;
  bool writing_ = false;
  bool over_ = false;
  bool admitted_ = false;
  HealthService::Status sent_ = HealthCheckResponse::UNKNOWN;
};

void HealthService::Serve(CallQueue* queue) {
  watches_.try_emplace(queue);
  // Both delete themselves.
  new HealthCheck(this, queue);
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

absl::Status HealthService::Admit(const HealthCheckRequest& request,
                                  const std::string& peer) {
  // A watch keeps its request for as long as it is open.
  const size_t size = request.service().size();
  if (size > limits::kMaxNameBytes) {
    return InvalidConfig(
        "length of service", size,
        absl::StrCat("at most ", limits::kMaxNameBytes, " bytes"));
  }
  return watch_gate_.Enter(peer);
}

}  // namespace tactus::internal::server
