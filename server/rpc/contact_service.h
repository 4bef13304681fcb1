// File: contact_service.h
//
// ContactService: admits streams, keeps count of them and drains them.
//
// Thread-safe. Must outlive the gRPC server it is registered with.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <unordered_set>
#include <vector>

#include "server/ops/skip_totals.h"
#include "server/ops/stream_gate.h"
#include "server/rpc/contact_stream.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::server {

// Streams move raw bytes, so that a message is measured before it is parsed
// and one that cannot be parsed is told from a half-close.
using ContactServiceBase =
    v1::ContactService::WithRawCallbackMethod_ClassifyContact<
        v1::ContactService::WithCallbackMethod_ClassifyTrial<
            v1::ContactService::Service>>;

class ContactService : public ContactServiceBase {
 public:
  struct Options {
    int max_streams = 0;
    // 0 means none.
    int idle_timeout_ms = 0;
    std::string server_version;
  };

  // `models` must outlive this object.
  ContactService(const ModelSource* models, Options options);

  BytesReactor* ClassifyContact(grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* ClassifyTrial(
      grpc::CallbackServerContext* context,
      const v1::ClassifyTrialRequest* request,
      v1::ClassifyTrialResponse* response) override;

  // Refuses new streams and tells those there are.
  void StartDraining(std::chrono::milliseconds grace);
  // Ends all streams with DRAINING, their finals delivered first.
  void EndStreams();
  // True once no stream is left, false after `timeout`.
  bool WaitUntilEmpty(std::chrono::milliseconds timeout);

  const StreamGate& gate() const { return gate_; }
  // Of the streams that have ended.
  const SkipTotals& skipped() const { return skipped_; }

 private:
  std::vector<std::shared_ptr<ContactStream>> Streams();
  void OnStreamDone(ContactStream* stream);

  const ModelSource* models_;
  const Options options_;
  StreamGate gate_;
  SkipTotals skipped_;
  std::atomic<uint64_t> next_stream_ = 1;

  std::mutex mutex_;
  std::condition_variable stream_done_;
  bool draining_ = false;
  std::unordered_set<std::shared_ptr<ContactStream>> streams_;
};

}  // namespace tactus::server
