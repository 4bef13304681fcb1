// File: trial_call.h
//
// TrialCall: carries one ClassifyTrial RPC between gRPC and a TrialSession. A
// trial is taken part by part while its queue has no other event to handle, so
// that streams do not wait for it. A client has the idle timeout of the
// session's options to read the answer.
//
//   new TrialCall(service, queue, delegate);  // awaits a call
//
// Deletes itself after the answer or the timeout. Everything, including the
// constructor and the delegate's functions, runs on the queue's thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/alarm.h"
#include "grpcpp/support/async_unary_call.h"
#include "server/metrics/server_metrics.h"
#include "server/rpc/call_queue.h"
#include "server/rpc/contact_call.h"
#include "server/rpc/incoming_call.h"
#include "server/session/trial_session.h"

namespace tactus::internal::server {

class TrialCall {
 public:
  // Admits calls and provides what they share.
  class Delegate {
   public:
    // A call has come: awaits the next one on `call`'s queue, and returns the
    // options of this one or why it is refused.
    virtual absl::StatusOr<StreamSession::Options> Admit(TrialCall* call) = 0;
    // A call that was admitted has ended.
    virtual void Release(TrialCall* call) = 0;
    virtual const ModelSource* models() const = 0;
    virtual ServerMetrics* metrics() const = 0;
    // The message that calls of a queue parse into.
    virtual v1::ClassifyContactRequest* request(CallQueue* queue) = 0;

   protected:
    ~Delegate() = default;
  };

  static constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyTrial";

  // All three must outlive it.
  TrialCall(RawContactService* service, CallQueue* queue, Delegate* delegate);

  TrialCall(const TrialCall&) = delete;
  TrialCall& operator=(const TrialCall&) = delete;

  CallQueue* queue() const { return call_.queue(); }
  const grpc::ServerContext& context() const { return call_.context(); }
  // The peer that made the call, as PeerOf names it.
  const std::string& peer() const { return call_.peer(); }
  const StreamSession& session() const { return trial_->session(); }
  // The client was there to take the answer.
  bool delivered() const { return delivered_; }

 private:
  using Event = MemberEvent<TrialCall>;

  ~TrialCall() = default;

  void OnCalled(bool ok);
  void OnTurn(bool idle);
  void OnFinished(bool ok);
  void OnTimeout(bool ok);
  // Sends the response if `status` is OK, else the error.
  void Finish(const absl::Status& status);
  void DeleteIfOver();

  RawContactService* const service_;
  Delegate* const delegate_;

  IncomingCall call_;
  grpc::ByteBuffer request_;
  grpc::ServerAsyncResponseWriter<grpc::ByteBuffer> writer_{call_.context()};
  Event called_{this, &TrialCall::OnCalled};
  Event turn_{this, &TrialCall::OnTurn};
  Event finished_{this, &TrialCall::OnFinished};
  Event timeout_{this, &TrialCall::OnTimeout};

  int64_t called_ns_ = 0;
  absl::StatusCode code_ = absl::StatusCode::kOk;
  // 0 for none.
  uint32_t answer_timeout_ms_ = 0;
  grpc::Alarm answer_alarm_;
  // Operations whose events have not come yet, from Finish on.
  int in_flight_ = 0;
  bool delivered_ = false;
  // Set when the call is admitted.
  std::optional<TrialSession> trial_;
};

}  // namespace tactus::internal::server
