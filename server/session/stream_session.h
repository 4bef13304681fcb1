// File: stream_session.h
//
// StreamSession: one ClassifyContact stream without its transport. It takes
// requests, puts answers into responses(), and ends with a status.
//
//   StreamSession session(models, {.stream_id = "7"});
//   session.OnMessage(&bytes, size, &request).IgnoreError();
//   session.EndRequest(start_ns, now_ns);
//   while (auto* answer = session.responses().StartWrite(now_ns)) {
//     Write(*answer);
//     session.responses().FinishWrite();
//   }
//   if (session.state() == StreamSession::State::kDone) {
//     Finish(session.final_status());
//   }
//
//   WAIT_CONFIG --config--> STREAMING --half-close, error, Finish--> FINISHING
//   FINISHING --all answers written--> DONE
//
// A message is checked whole before any of its frames is used. The session
// keeps its model from `config` until it is destroyed. No threads, no clock:
// the caller serialises calls and passes the time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "core/stream/contact_session.h"
#include "core/stream/stream_settings.h"
#include "google/protobuf/io/zero_copy_stream.h"
#include "server/session/model_source.h"
#include "server/session/response_queue.h"
#include "tactus/v1/contact.pb.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::server {

class StreamSession {
 public:
  struct Options {
    std::string stream_id = {};
    std::string server_version = {};
    // As whom the server knows the client; only for those who watch.
    std::string caller = {};
    // Only reported to the client; 0 means no timeout.
    uint32_t idle_timeout_ms = 0;
  };
  enum class State { kWaitConfig, kStreaming, kFinishing, kDone };

  // `models` must outlive the session.
  StreamSession(const ModelSource* models, Options options);

  // Takes the next message, `size` bytes from the wire. An error ends the
  // stream: the state is then FINISHING. The message is parsed into `request`,
  // which keeps its memory; sessions of one thread may share it.
  absl::Status OnMessage(google::protobuf::io::ZeroCopyInputStream* bytes,
                         size_t size, v1::ClassifyContactRequest* request);
  // The same for a message already parsed.
  absl::Status OnRequest(const v1::ClassifyContactRequest& request);
  // Sets the computing time of the last message in its answers.
  void EndRequest(int64_t start_ns, int64_t now_ns);

  // The client sends no more messages: an open trial gets its final.
  void OnHalfClose();
  // The server will stop within `grace_ms`: adds a notice for the client.
  void OnDraining(uint32_t grace_ms);
  // Shows frames and answers to `tap` from now on; after the config. `tap` must
  // outlive the session.
  void SetTap(StreamTap* tap) { contacts_->SetTap(tap); }
  // Writes what the stream is, without its peer and its start; after the
  // config.
  void Describe(v1::OpenStream* stream) const;
  // The config as the robot sent it.
  const v1::StreamConfig& config() const { return config_; }

  // Ends the stream from the server's side with `status`, after the final of
  // an open trial.
  void Finish(absl::Status status);

  State state() const;
  // How the stream ends; meaningful in FINISHING and DONE.
  const absl::Status& final_status() const { return final_status_; }
  // False while too many finals wait, and once the stream is finishing.
  bool wants_request() const { return !finishing_ && !responses_.full(); }
  ResponseQueue& responses() { return responses_; }
  uint64_t frames() const { return contacts_ ? contacts_->frames() : 0; }
  // Null before the config.
  const ContactSession* contacts() const {
    return contacts_ ? &*contacts_ : nullptr;
  }
  // Names the stream in logs, for example: stream 7 of client "left-arm".
  std::string LogName() const;
  // Compares the capture times of the frames with the config's rate; null
  // before the config.
  const RateWatch* rate() const {
    return contacts_ ? &contacts_->rate() : nullptr;
  }
  // What was skipped so far.
  SkipCounters skipped() const {
    return contacts_ ? contacts_->skipped() : SkipCounters();
  }

 private:
  // Ends the stream if `status` is an error; returns it.
  absl::Status EndIfError(absl::Status status);
  absl::Status Take(const v1::ClassifyContactRequest& request);
  absl::Status Dispatch(const v1::ClassifyContactRequest& request);
  absl::Status OnConfig(const v1::StreamConfig& config);
  void WriteStarted(v1::StreamStarted* started) const;
  // Adds a notice, once per stream, if the name in the config now stands for
  // another version.
  void CheckForNewerModel();

  const ModelSource* models_;
  Options options_;
  ResponseQueue responses_;
  bool finishing_ = false;
  absl::Status final_status_;

  // Set by config.
  v1::StreamConfig config_;
  StreamSettings settings_;
  std::optional<PinnedModel> pinned_;
  // Generation of models_ when it was asked last.
  uint64_t generation_ = 0;
  // The client was sent KIND_MODEL_SUPERSEDED.
  bool superseded_ = false;
  std::optional<ContactSession> contacts_;
};

}  // namespace tactus::internal::server
