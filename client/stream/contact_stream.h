// File: contact_stream.h
//
// ContactStream: one ClassifyContact stream as a robot uses it.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto stream,
//       ContactStream::Open(MakeChannel("127.0.0.1:50051"), MakeConfig(info),
//                           [](const auto& response) {
//                             if (response.has_answer()) {
//                               Use(response.answer());
//                             }
//                           }));
//   FrameEncoder encoder(info, {});
//   encoder.Add(frame);
//   TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
//   TACTUS_ASSIGN_OR_RETURN(const v1::Answer answer, stream->EndTrial());
//   TACTUS_RETURN_IF_ERROR(stream->Close());
//
// Every response is checked before the callback sees it (response_checker.h),
// and no call waits longer than its timeout: a server that is silent or breaks
// the contract ends the stream with an error.
//
// The final status is kept. Once the stream has ended, every call returns the
// error that it ended with. After an end without error, Close returns OK and
// all other calls return STREAM_FINISHED. A stream that goes on after a lost
// connection is a ResumableStream (resumable_stream.h).
//
// One thread reads the responses with gRPC's blocking interface, because its
// callback interface may sleep 100 ms when a silence ends. A second thread
// bounds the waits; it sleeps while the server responds.
//
// Open, Send, EndTrial and Close belong to one thread. The callback runs on
// the reading thread and must not call them. Cancel and ended may be called
// from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/stream/channel.h"
#include "client/stream/response_checker.h"
#include "client/stream/watchdog.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::internal::client {

// How long a server may take. 0 is no limit.
struct StreamTimeouts {
  // From Open to the server's `started`, with the time to connect.
  std::chrono::milliseconds open{10'000};
  // For one message to leave. Send waits if the server stops reading.
  std::chrono::milliseconds send{10'000};
  // From EndTrial to the trial's final answer.
  std::chrono::milliseconds final_answer{10'000};
  // From Close to the stream's status.
  std::chrono::milliseconds close{10'000};
};

class ContactStream {
 public:
  // Called for every response after `started`.
  using OnResponse = std::function<void(const v1::ClassifyContactResponse&)>;
  // Called once, on the reading thread, when no further response can come.
  using OnEnd = std::function<void()>;

  // Returns the stream once the server has accepted the configuration, or the
  // server's error. NO_RESPONSE after the timeout. `token`, if not empty, is
  // sent as the caller's bearer token; only TLS, a unix socket or a loopback
  // address keep it secret.
  //
  // The client_id of `config` is also sent as the metadata x-robot-id, so that
  // a proxy can send all streams of a robot to one server. It is left out if
  // it is empty or no legal metadata value (robot_id.h).
  static absl::StatusOr<std::unique_ptr<ContactStream>> Open(
      const std::shared_ptr<grpc::Channel>& channel,
      const v1::StreamConfig& config, OnResponse on_response,
      const StreamTimeouts& timeouts = {}, const std::string& token = "",
      OnEnd on_end = {});

  // Cancels the stream unless it has ended.
  ~ContactStream();

  ContactStream(const ContactStream&) = delete;
  ContactStream& operator=(const ContactStream&) = delete;

  // What the server runs for this stream.
  const v1::StreamStarted& started() const { return started_; }

  // Sends frames (or any other request).
  absl::Status Send(const v1::ClassifyContactRequest& request);
  // Ends the trial and returns its final answer.
  absl::StatusOr<v1::Answer> EndTrial();
  // Ends the stream: the server first sends what it still owes, with the final
  // answer of an open trial.
  absl::Status Close();

  // True once no further response can come.
  bool ended();
  void Cancel() { context_.TryCancel(); }

 private:
  ContactStream(OnResponse on_response, OnEnd on_end,
                const StreamTimeouts& timeouts);

  absl::Status Begin(const std::shared_ptr<grpc::Channel>& channel,
                     const v1::StreamConfig& config);
  void ReadAll();
  void OnChecked(const v1::ClassifyContactResponse& response);
  // Writes without a timeout.
  absl::Status Write(const v1::ClassifyContactRequest& request);
  // Joins the reading thread and returns how the stream ended.
  absl::Status Join();

  const OnResponse on_response_;
  const OnEnd on_end_;
  const StreamTimeouts timeouts_;
  grpc::ClientContext context_;
  Watchdog watchdog_{[this] { Cancel(); }};
  ResponseChecker checker_;
  std::unique_ptr<v1::ContactService::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ClassifyContactRequest,
                                           v1::ClassifyContactResponse>>
      rpc_;
  v1::ClassifyContactRequest end_of_trial_;
  uint64_t trials_ended_ = 0;
  std::thread reader_;
  // Written by the reading thread before it ends.
  absl::Status final_status_;

  std::mutex mutex_;
  std::condition_variable answered_;
  bool has_started_ = false;
  bool ended_ = false;
  v1::StreamStarted started_;
  // Number of final answers, and the last one.
  uint64_t finals_ = 0;
  v1::Answer final_;
};

}  // namespace tactus::internal::client
