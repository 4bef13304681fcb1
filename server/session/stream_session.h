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

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "core/base/limits.h"
#include "core/base/rate_watch.h"
#include "core/classify/contact_pipeline.h"
#include "google/protobuf/io/zero_copy_stream.h"
#include "server/session/answer_writer.h"
#include "server/session/frame_decoder.h"
#include "server/session/model_source.h"
#include "server/session/response_queue.h"
#include "server/session/stream_settings.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::server {

class StreamSession {
 public:
  struct Options {
    std::string stream_id = {};
    std::string server_version = {};
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
  // Ends the stream from the server's side with `status`, after the final of
  // an open trial.
  void Finish(absl::Status status);

  State state() const;
  // How the stream ends; meaningful in FINISHING and DONE.
  const absl::Status& final_status() const { return final_status_; }
  // False while too many finals wait, and once the stream is finishing.
  bool wants_request() const { return !finishing_ && !responses_.full(); }
  ResponseQueue& responses() { return responses_; }
  uint64_t frames() const { return frames_; }
  // Names the stream in logs, for example: stream 7 of client "left-arm".
  std::string LogName() const;
  // Compares the capture times of the frames with the config's rate; null
  // before the config.
  const RateWatch* rate() const { return rate_ ? &*rate_ : nullptr; }
  // What was skipped so far.
  SkipCounters skipped() const;

 private:
  // Ends the stream if `status` is an error; returns it.
  absl::Status EndIfError(absl::Status status);
  absl::Status Take(const v1::ClassifyContactRequest& request);
  absl::Status Dispatch(const v1::ClassifyContactRequest& request);
  absl::Status OnConfig(const v1::StreamConfig& config);
  absl::Status OnFrames(const v1::FrameBatch& batch);
  void OnFrame(const v1::FrameBatch& batch, uint32_t index,
               uint64_t missing_before);
  // Adds a notice, once per stream, if the capture times are those of another
  // rate. `missing` frames were lost before `batch`.
  void WatchRate(const v1::FrameBatch& batch, uint64_t missing);
  void OnEndOfTrial();
  // True if the cadence asks for an interim answer after this frame.
  bool IsDue();
  // True if the contacts, or what they probably are, differ from those of the
  // frame before.
  bool HasChanged();
  void WriteStarted();
  // Makes the pipeline of a configured stream; OnConfig has checked that this
  // cannot fail.
  void MakePipeline();
  // Adds a notice, once per stream, if the name in the config now stands for
  // another version.
  void CheckForNewerModel();

  const ModelSource* models_;
  Options options_;
  ResponseQueue responses_;
  bool finishing_ = false;
  absl::Status final_status_;

  // Set by config.
  StreamSettings settings_;
  std::optional<PinnedModel> pinned_;
  // Generation of models_ when it was asked last.
  uint64_t generation_ = 0;
  // The client was sent KIND_MODEL_SUPERSEDED.
  bool superseded_ = false;
  // Made for the first frame, because it is most of a stream's memory.
  std::unique_ptr<ContactPipeline> pipeline_;
  std::optional<FrameDecoder> decoder_;
  std::optional<AnswerWriter> writer_;
  std::optional<RateWatch> rate_;

  uint64_t frames_ = 0;
  // Frames of the open trial; 0 if none is open.
  uint64_t trial_frames_ = 0;
  // Contacts of the frame before by id, with their best classes; for
  // RESULT_CADENCE_ON_CHANGE.
  struct Seen {
    uint64_t id = 0;
    int best_class = 0;
    bool operator==(const Seen&) const = default;
  };
  std::array<Seen, limits::kMaxContacts> seen_ = {};
};

}  // namespace tactus::server
