// File: contact_stream.h
//
// ContactStream: carries one ClassifyContact RPC between gRPC and a
// StreamSession. At most one read and one write are in flight; every event
// ends in Advance(), which starts what may be started next.
//
// Lives until gRPC is done with the RPC and nobody holds it. Reactions and the
// public functions may come from any thread; a mutex per stream orders them.
// gRPC never runs a reaction inside StartRead, StartWrite or Finish, so they
// may be called with the mutex held.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

#include "absl/status/status.h"
#include "grpcpp/alarm.h"
#include "grpcpp/server_context.h"
#include "server/rpc/refusal.h"
#include "server/session/stream_session.h"

namespace tactus::server {

class ContactStream : public BytesReactor,
                      public std::enable_shared_from_this<ContactStream> {
 public:
  struct Options {
    StreamSession::Options session;
    // Silence that ends the stream; 0 means none.
    int idle_timeout_ms = 0;
    // Called once, last.
    std::function<void(ContactStream*)> on_done;
  };

  ContactStream(grpc::CallbackServerContext* context, const ModelSource* models,
                Options options);

  // Starts reading. Once, after construction.
  void Start();
  // Tells the client that the server will stop.
  void Drain(uint32_t grace_ms);
  // Ends the stream with `status`, after what is owed.
  void End(const absl::Status& status);

  uint64_t frames() const { return session_.frames(); }
  SkipCounters skipped() const { return session_.skipped(); }

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  void TakeMessage();
  void Advance();
  void StartNextWrite();
  void SetIdleAlarm(int64_t delay_ns);
  void OnIdleAlarm();

  grpc::CallbackServerContext* const context_;
  const Options options_;
  // Dropped in OnDone.
  std::shared_ptr<ContactStream> self_;

  std::mutex mutex_;
  StreamSession session_;
  grpc::ByteBuffer read_;
  grpc::ByteBuffer write_;
  bool reading_ = false;
  bool writing_ = false;
  // The peer is gone: nothing more can be written.
  bool broken_ = false;
  // Finish was called.
  bool finished_ = false;
  int64_t last_read_ns_ = 0;
  std::unique_ptr<grpc::Alarm> idle_alarm_;
};

}  // namespace tactus::server
