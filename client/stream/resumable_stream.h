// File: resumable_stream.h
//
// ResumableStream: a ContactStream that survives the loss of its connection and
// the restart of its server, also in the middle of a contact.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto stream,
//       ResumableStream::Open(MakeChannel("arm.lab:50051"), MakeConfig(info),
//                             [](const auto& response) { Use(response); },
//                             {.resume_for = std::chrono::seconds(30)}));
//   FrameEncoder encoder(info, {});
//   encoder.Add(frame);
//   TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
//   TACTUS_ASSIGN_OR_RETURN(const v1::Answer answer, stream->EndTrial());
//   TACTUS_RETURN_IF_ERROR(stream->Close());
//
// When the stream is lost, it opens another one and sends the frames again that
// the answers depend on (stream_history.h). The callback then gets what it
// would have got from one stream, with the robot's own sequence numbers and
// times: no answer twice, and none left out except the interim ones that a
// server may drop, which `superseded` counts.
//
// What it resumes after:
//   - UNAVAILABLE, which a server that drains also returns, a broken
//     connection, and a timeout of `timeouts`;
//   - an end that the robot did not ask for: the server ends the stream with
//     OK, or because it was idle. After an idle end it waits until there is
//     something to send;
//   - STREAM_LIMIT while it resumes: the server may still count the lost
//     stream, or many robots return at once.
// Any other status of the server ends it at once: INVALID_ARGUMENT, NOT_FOUND,
// PERMISSION_DENIED, UNAUTHENTICATED, FAILED_PRECONDITION and the like, and
// RESOURCE_EXHAUSTED for another reason, because the same frames would fail
// again. So does every error of the first Open.
//
// It waits between two attempts (backoff.h) and gives up with NO_RESPONSE when
// `resume_for` has passed since the loss without a new answer. The model's
// version stays: new streams ask for the version that the first one got. If the
// server no longer has it, that is MODEL_NOT_FOUND; if it has another bundle
// under that name, FAILED_PRECONDITION. Streams that were resumed get no
// KIND_MODEL_SUPERSEDED.
//
// While the stream is lost, Send keeps the frames and returns at once. It waits
// only if there is no room for frames that no server has got yet. Then each of
// these frames waits for the answer to the one before, for at most half of its
// sample period, so that their answers do not supersede each other.
//
// If a trial, or on most skins a contact, is longer than `replay_bytes`, its
// beginning is not kept. Resumed there, the rest of the contact is answered as
// a new contact with a new contact_id, and answers that were owed for frames
// that are not kept do not come; statistics().without_beginning counts it.
//
// A thread resumes; it sleeps while the stream is in order. Send, EndTrial and
// Close belong to one thread. The callback runs on a reading thread and must
// not call them. Cancel, ended, resuming and statistics may be called from any
// thread. The destructor may take as long as timeouts.open if an attempt is
// under way.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/stream/backoff.h"
#include "client/stream/contact_stream.h"
#include "client/stream/stream_history.h"
#include "core/base/limits.h"
#include "grpcpp/channel.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

struct ResumeOptions {
  StreamTimeouts timeouts = {};
  // The robot's bearer token; empty: none.
  std::string token = {};
  // How long a loss may last; 0: every loss ends the stream.
  std::chrono::milliseconds resume_for{30'000};
  // Bytes of frames that are kept; from limits::kMinReplayBytes to
  // limits::kMaxReplayBytes.
  size_t replay_bytes = limits::kMaxReplayBytes;
};

class ResumableStream {
 public:
  struct Statistics {
    // Streams after the first.
    uint64_t resumed = 0;
    // Frames that were sent again.
    uint64_t replayed_frames = 0;
    // Streams after the first that began in the middle of
    // something: the frames before were no longer kept.
    uint64_t without_beginning = 0;
  };

  // Returns the stream once the server has accepted the configuration, or the
  // server's error.
  static absl::StatusOr<std::unique_ptr<ResumableStream>> Open(
      std::shared_ptr<grpc::Channel> channel, const v1::StreamConfig& config,
      ContactStream::OnResponse on_response, const ResumeOptions& options = {});

  // Cancels the stream unless it has ended.
  ~ResumableStream();

  ResumableStream(const ResumableStream&) = delete;
  ResumableStream& operator=(const ResumableStream&) = delete;

  // What the server runs for this stream; from the first connection.
  const v1::StreamStarted& started() const { return started_; }

  // Sends frames. INVALID_ARGUMENT for any other request and for frames whose
  // sequence numbers do not rise; the stream then goes on.
  absl::Status Send(const v1::ClassifyContactRequest& request);
  // Ends the trial and returns its final answer.
  absl::StatusOr<v1::Answer> EndTrial();
  // Ends the stream: the server first sends what it still owes, with the final
  // answer of an open trial. A stream that is lost is resumed for it.
  absl::Status Close();

  // True once no further response can come.
  bool ended();
  // True while the stream is lost, until all frames have been sent again.
  bool resuming();
  Statistics statistics();
  void Cancel();

 private:
  enum class State { kConnected, kResuming, kEnded };
  using Lock = std::unique_lock<std::mutex>;
  using Clock = std::chrono::steady_clock;

  ResumableStream(std::shared_ptr<grpc::Channel> channel,
                  const v1::StreamConfig& config,
                  ContactStream::OnResponse on_response,
                  const ResumeOptions& options);

  // Run on the caller's thread. What is sent here is also kept, so an error
  // does not matter: the other thread sees the end of the stream.
  absl::Status CheckFrames(const v1::ClassifyContactRequest& request) const;
  void SendNow(const v1::ClassifyContactRequest& request, Lock& lock);
  void SendEnd(Lock& lock);
  absl::Status EndStatus() const;
  // The robot waits for a final, or will by Close.
  bool Owes() const;

  // Run on the reading threads.
  void OnResponse(const v1::ClassifyContactResponse& response);
  void OnEnd();

  // Run on the resuming thread.
  void Run();
  // Waits for the end of the stream and returns its status.
  absl::Status AwaitEnd(Lock& lock);
  // The status that ends all, or nothing if the stream is to be resumed.
  std::optional<absl::Status> Verdict(const absl::Status& status);
  // Opens streams until one has got all frames; else returns how all ends.
  std::optional<absl::Status> Resume(absl::Status status, Lock& lock);
  absl::Status OpenAgain(Clock::time_point deadline, Lock& lock);
  // Waits until a connection stands or failed.
  void AwaitConnection(Clock::time_point until, Lock& lock);
  absl::Status CheckBundle(const v1::StreamStarted& started) const;
  absl::StatusOr<std::unique_ptr<ContactStream>> Connect(
      const StreamTimeouts& timeouts);
  // Sends all that the stream has not got. False if the stream ended.
  bool CatchUp(Lock& lock);
  // Waits until a batch that was sent again is answered, or long enough.
  void AwaitAnswer(const v1::FrameBatch& batch, Lock& lock);
  std::chrono::milliseconds PauseFor(const v1::FrameBatch& batch) const;

  const std::shared_ptr<grpc::Channel> channel_;
  v1::StreamConfig config_;
  const ContactStream::OnResponse on_response_;
  const ResumeOptions options_;
  v1::ClassifyContactRequest end_of_trial_;
  v1::StreamStarted started_;

  std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::kConnected;
  absl::Status final_status_;
  // Valid from the first stream's start on.
  std::optional<StreamHistory> history_;
  std::unique_ptr<ContactStream> stream_;
  // The reading thread of stream_ has reported its end.
  bool is_over_ = false;
  // The caller's thread uses stream_.
  bool is_sending_ = false;
  bool is_closing_ = false;
  bool is_cancelled_ = false;
  // The current stream has got end_of_trial for this trial.
  bool end_is_sent_ = false;
  std::optional<Clock::time_point> final_due_;
  std::optional<v1::Answer> final_;
  Statistics statistics_;

  // When the stream was lost, and when it was resumed last.
  Clock::time_point lost_at_;
  Clock::time_point resumed_at_;
  // The robot has got an answer since the stream was lost.
  bool has_progressed_ = true;
  Backoff backoff_;
  // The resuming thread's.
  v1::ClassifyContactRequest request_;
  // Last, because it uses all others.
  std::thread thread_;
};

}  // namespace tactus::internal::client
