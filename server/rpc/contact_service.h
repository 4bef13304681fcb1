// File: contact_service.h
//
// ContactService: admits streams and trials, counts them and drains the
// streams.
//
//   builder.RegisterService(&service);
//   const auto server = builder.BuildAndStart();
//   service.Serve(&queue);
//
// Thread-safe. The delegates' functions are called on the thread of each call's
// queue. Must outlive the gRPC server it is registered with, and its queues.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "server/contact_log/contact_log.h"
#include "server/monitor/open_streams.h"
#include "server/ops/authorizer.h"
#include "server/ops/client_streams.h"
#include "server/ops/log_limiter.h"
#include "server/ops/skip_totals.h"
#include "server/ops/stream_gate.h"
#include "server/rpc/call_queue.h"
#include "server/rpc/contact_call.h"
#include "server/rpc/trial_call.h"

namespace tactus::internal::server {

class ContactService final : public RawContactService,
                             private ContactCall::Delegate,
                             private TrialCall::Delegate {
 public:
  struct Options {
    int max_streams = 0;
    // 0 means none, for each of these.
    int max_streams_per_peer = 0;
    // A client is a token, a certificate or, without credentials, a peer.
    int max_streams_per_client = 0;
    int idle_timeout_ms = 0;
    int first_message_timeout_ms = 0;
    std::string server_version;
    // Where contacts are kept; null if they are not.
    ContactLog* contact_log = nullptr;
  };

  // Calls need the role of a robot. All pointers must outlive this object.
  ContactService(const ModelSource* models, const Authorizer* authorizer,
                 ServerMetrics* metrics, Options options);

  // Accepts streams on `queue`. Call it before any queue starts.
  void Serve(CallQueue* queue);

  // Refuses new streams and sends a notice to the open ones.
  void StartDraining(std::chrono::milliseconds grace);
  // Ends all streams with DRAINING, their finals delivered first.
  void EndStreams();
  // True once no stream is left, false after `timeout`.
  bool WaitUntilEmpty(std::chrono::milliseconds timeout);

  // Adds what streams have done.
  void Collect(Families* families) const;

  // The streams that are open and configured.
  OpenStreams& streams() { return open_streams_; }

  const StreamGate& gate() const { return gate_; }
  // Work that the streams which have ended skipped.
  const SkipTotals& skipped() const { return skipped_; }

 private:
  // What belongs to the thread of a queue.
  struct Lane {
    std::unordered_set<ContactCall*> streams;
    v1::ClassifyContactRequest request;
    LaneMetrics metrics;
  };

  absl::StatusOr<StreamSession::Options> Admit(ContactCall* stream) override;
  absl::StatusOr<StreamSession::Options> Admit(TrialCall* call) override;
  ContactCall::Observers Open(ContactCall* stream) override;
  void Release(ContactCall* stream) override;
  void Release(TrialCall* call) override;
  // The options of a call that may run, or why it may not, which is counted.
  absl::StatusOr<StreamSession::Options> Enter(
      const void* call, const grpc::ServerContext& context,
      absl::string_view method, const std::string& peer);
  absl::StatusOr<StreamSession::Options> TryToEnter(
      const void* call, const grpc::ServerContext& context,
      absl::string_view method, const std::string& peer);
  // `delivered`: the client took the end.
  void Leave(const std::string& peer, const StreamSession& session,
             bool delivered);
  const ModelSource* models() const override { return models_; }
  ServerMetrics* metrics() const override { return metrics_; }
  LaneMetrics* lane_metrics(CallQueue* queue) override {
    return &lanes_.at(queue).metrics;
  }
  int first_message_timeout_ms() const override {
    return options_.first_message_timeout_ms;
  }
  v1::ClassifyContactRequest* request(CallQueue* queue) override {
    return &lanes_.at(queue).request;
  }

  // On the thread of each queue.
  void ForEachStream(std::function<void(ContactCall*)> visit);

  const ModelSource* const models_;
  const Authorizer* const authorizer_;
  ServerMetrics* const metrics_;
  const Options options_;
  StreamGate gate_;
  ClientStreams clients_;
  OpenStreams open_streams_;
  SkipTotals skipped_;
  LogLimiter stream_log_{{.lines_per_second = 20, .burst = 200}};
  std::atomic<uint64_t> next_stream_ = 1;
  std::atomic<bool> draining_ = false;
  // Which queues there are is fixed once they start.
  std::unordered_map<CallQueue*, Lane> lanes_;

  std::mutex mutex_;
  std::condition_variable stream_done_;
};

}  // namespace tactus::internal::server
