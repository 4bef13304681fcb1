// File: contact_call.h
//
// ContactCall: carries one ClassifyContact RPC between gRPC and a
// StreamSession. At most one read and one write are in flight; every event
// ends in Advance(), which starts what may be started next.
//
//   new ContactCall(service, queue, delegate);  // awaits a call
//
// Deletes itself once it has no operation in flight. Everything, including the
// constructor and the delegate's functions, runs on the queue's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/alarm.h"
#include "grpcpp/support/async_stream.h"
#include "server/contact_log/contact_recorder.h"
#include "server/metrics/lane_metrics.h"
#include "server/metrics/server_metrics.h"
#include "server/monitor/watched_stream.h"
#include "server/rpc/answer_pacing.h"
#include "server/rpc/call_queue.h"
#include "server/rpc/incoming_call.h"
#include "server/session/stream_session.h"
#include "server/session/tap_pair.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::internal::server {

// Calls move raw bytes: a message is measured before it is parsed, and one that
// cannot be parsed is not mistaken for a half-close.
using RawContactService = v1::ContactService::WithRawMethod_ClassifyContact<
    v1::ContactService::WithRawMethod_ClassifyTrial<
        v1::ContactService::Service>>;

class ContactCall {
 public:
  static constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyContact";

  // Who sees what a stream does, beside its robot.
  struct Observers {
    WatchedStream* watched = nullptr;
    // Null if contacts are not kept.
    std::unique_ptr<ContactRecorder> recorder = {};
    AnswerMetrics::Series series;
  };

  // Admits streams and provides what they share.
  class Delegate {
   public:
    // A call has come: awaits the next one on `stream`'s queue, and returns the
    // options of this one or why it is refused.
    virtual absl::StatusOr<StreamSession::Options> Admit(
        ContactCall* stream) = 0;
    // A stream that was admitted has its config. Returns who sees what it does;
    // valid until Release.
    virtual Observers Open(ContactCall* stream) = 0;
    // A stream that was admitted has ended.
    virtual void Release(ContactCall* stream) = 0;
    virtual const ModelSource* models() const = 0;
    virtual ServerMetrics* metrics() const = 0;
    // What the streams of a queue count.
    virtual LaneMetrics* lane_metrics(CallQueue* queue) = 0;
    // Time a stream has for its first message; 0 means no limit.
    virtual int first_message_timeout_ms() const = 0;
    // The message that streams of a queue parse into.
    virtual v1::ClassifyContactRequest* request(CallQueue* queue) = 0;

   protected:
    ~Delegate() = default;
  };

  // All three must outlive it. The idle timeout is in the session's options.
  ContactCall(RawContactService* service, CallQueue* queue, Delegate* delegate);

  ContactCall(const ContactCall&) = delete;
  ContactCall& operator=(const ContactCall&) = delete;

  // Tells the client that the server will stop.
  void Drain(uint32_t grace_ms);
  // Ends the stream with `status`, after what is owed.
  void End(const absl::Status& status);

  CallQueue* queue() const { return call_.queue(); }
  const grpc::ServerContext& context() const { return call_.context(); }
  // The peer that opened the stream, as PeerOf names it.
  const std::string& peer() const { return call_.peer(); }
  // The session of a stream that was admitted.
  const StreamSession& session() const { return *session_; }
  // The client was there to take the status at the end.
  bool delivered() const { return delivered_; }
  // Null before the config.
  const WatchedStream* watched() const { return observers_.watched; }

 private:
  using Event = MemberEvent<ContactCall>;

  ~ContactCall() = default;

  void OnCalled(bool ok);
  void OnRead(bool ok);
  void OnWritten(bool ok);
  void OnIdle(bool ok);
  void OnNothingMore(bool ok);
  void OnFinished(bool ok);

  void TakeMessage();
  // Asks who sees the stream, once it has its config.
  void Open();
  // Tells the observers of a message that took from `start_ns` to `end_ns`.
  void Observe(int64_t start_ns, int64_t end_ns);
  void Advance();
  void StartNextRead();
  // Puts the next answer, which must be waiting, into write_.
  void StageNextWrite();
  void StartStagedWrite();
  // Holds the waiting answer until the queue is empty.
  void Hold();
  // The idle time that ends the stream in its present state; 0 for none.
  int TimeoutMs() const;
  void SetIdleAlarm(int64_t delay_ns);
  void Finish(const grpc::Status& status);
  void DeleteIfOver();

  RawContactService* const service_;
  Delegate* const delegate_;

  IncomingCall call_;
  grpc::ServerAsyncReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer> stream_{
      call_.context()};
  Event called_{this, &ContactCall::OnCalled};
  Event read_done_{this, &ContactCall::OnRead};
  Event written_{this, &ContactCall::OnWritten};
  Event idle_{this, &ContactCall::OnIdle};
  Event nothing_more_{this, &ContactCall::OnNothingMore};
  Event finish_done_{this, &ContactCall::OnFinished};

  // From admission on.
  std::optional<StreamSession> session_;
  LaneMetrics* metrics_ = nullptr;
  Observers observers_;
  std::optional<TapPair> taps_;
  // After the last message.
  WatchedStream::Counts counts_;
  int64_t called_ns_ = 0;
  grpc::StatusCode code_ = grpc::StatusCode::OK;
  StreamSession::Options options_;
  v1::ClassifyContactRequest* request_ = nullptr;
  grpc::ByteBuffer read_;
  grpc::ByteBuffer write_;
  // Operations whose events have not come yet.
  int in_flight_ = 0;
  bool reading_ = false;
  // write_ holds an answer that is to be written next; it is being written.
  bool staged_ = false;
  bool writing_ = false;
  AnswerPacing pacing_;
  // The peer is gone: nothing more can be written.
  bool broken_ = false;
  // Finish was called.
  bool finished_ = false;
  bool delivered_ = false;
  int64_t last_read_ns_ = 0;
  grpc::Alarm idle_alarm_;
};

}  // namespace tactus::internal::server
