// File: fake_operation_service.h
//
// The OperationService of a FakeTrainingServer.
#pragma once

#include <chrono>
#include <string>

#include "core/base/errors.h"
#include "server/rpc/status.h"
#include "tests/client/training/fake_state.h"

namespace tactus::internal::client::testing {

class FakeOperationService : public v1::OperationService::Service {
 public:
  explicit FakeOperationService(FakeState* state) : state_(*state) {}

  grpc::Status GetOperation(grpc::ServerContext*,
                            const v1::GetOperationRequest* request,
                            v1::GetOperationResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.jobs.find(request->name());
    if (found == state_.jobs.end()) return NoJob(request->name());
    *response->mutable_operation() = found->second.operation;
    return state_.End(*response);
  }

  grpc::Status ListOperations(grpc::ServerContext*,
                              const v1::ListOperationsRequest* request,
                              v1::ListOperationsResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    for (const auto& [name, job] : state_.jobs) {
      if (request->state() == v1::Operation::STATE_UNSPECIFIED ||
          request->state() == job.operation.state()) {
        *response->add_operations() = job.operation;
      }
    }
    return state_.End(*response);
  }

  grpc::Status WatchOperation(
      grpc::ServerContext* context, const v1::WatchOperationRequest* request,
      grpc::ServerWriter<v1::WatchOperationResponse>* writer) override {
    if (grpc::Status s = state_.Begin("WatchOperation"); !s.ok()) return s;
    std::unique_lock lock(state_.mutex);
    const auto found = state_.jobs.find(request->name());
    if (found == state_.jobs.end()) return NoJob(request->name());
    size_t sent = 0;
    std::string last;
    for (;;) {
      const FakeJob& job = found->second;
      v1::WatchOperationResponse response;
      *response.mutable_operation() = job.operation;
      const std::string now = job.operation.SerializeAsString();
      const bool news = sent == 0 || sent < job.points.size() || now != last;
      for (; sent < job.points.size(); ++sent) {
        *response.add_points() = job.points[sent];
      }
      last = now;
      if (news) {
        state_.End(response);
        writer->Write(response);
      }
      if (state_.break_watches > 0) {
        --state_.break_watches;
        return grpc::Status(grpc::StatusCode::UNAVAILABLE, "broken");
      }
      if (Ended(job.operation) || state_.stopping || context->IsCancelled()) {
        return grpc::Status::OK;
      }
      ++state_.watchers;
      state_.changed.notify_all();
      state_.changed.wait_for(lock, std::chrono::milliseconds(10));
      --state_.watchers;
    }
  }

  grpc::Status CancelOperation(grpc::ServerContext*,
                               const v1::CancelOperationRequest* request,
                               v1::CancelOperationResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.jobs.find(request->name());
    if (found == state_.jobs.end()) return NoJob(request->name());
    v1::Operation& operation = found->second.operation;
    if (!Ended(operation)) {
      operation.set_state(v1::Operation::STATE_CANCELLED);
      state_.changed.notify_all();
    }
    *response->mutable_operation() = operation;
    return state_.End(*response);
  }

 private:
  static grpc::Status NoJob(const std::string& name) {
    return server::ToGrpcStatus(
        NoSuch(v1::ERROR_REASON_OPERATION_NOT_FOUND, "operation", name,
               "trainctl jobs list shows those that do"));
  }

  FakeState& state_;
};

}  // namespace tactus::internal::client::testing
