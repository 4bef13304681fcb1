// File: contact_stream.h
//
// ContactStream: one ClassifyContact stream as a robot uses it.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto stream, ContactStream::Open(channel, config, [](const auto& r) {
//         if (r.has_posterior()) Use(r.posterior());
//       }));
//   FrameEncoder encoder(...);
//   ...
//   TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
//   TACTUS_RETURN_IF_ERROR(stream->EndTrial());
//   TACTUS_RETURN_IF_ERROR(stream->Close());
//
// Answers are read by a thread of the stream's own with gRPC's blocking
// interface: its callback interface may sleep 100 ms when a silence ends.
//
// Open, Send, EndTrial and Close belong to one thread; the callback runs on
// the reading thread and must not call them. Cancel may come from anywhere.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/stream/channel.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::client {

class ContactStream {
 public:
  // Called for every answer after `started`.
  using OnResponse = std::function<void(const v1::ClassifyContactResponse&)>;

  // Returns once the server accepted the configuration; its error otherwise.
  static absl::StatusOr<std::unique_ptr<ContactStream>> Open(
      const std::shared_ptr<grpc::Channel>& channel,
      const v1::StreamConfig& config, OnResponse on_response);

  // Cancels the stream unless it was closed.
  ~ContactStream();

  ContactStream(const ContactStream&) = delete;
  ContactStream& operator=(const ContactStream&) = delete;

  // What the stream runs on.
  const v1::StreamStarted& started() const { return started_; }

  // Sends frames (or any other request). If the stream has ended, the error
  // it ended with.
  absl::Status Send(const v1::ClassifyContactRequest& request);
  // Asks for the final posterior of the trial.
  absl::Status EndTrial();
  // Ends an open trial, waits for the last answer and for the status.
  absl::Status Close();

  // True once no further answer can come. From any thread.
  bool ended();
  void Cancel() { context_.TryCancel(); }

 private:
  explicit ContactStream(OnResponse on_response)
      : on_response_(std::move(on_response)) {}

  absl::Status Begin(const std::shared_ptr<grpc::Channel>& channel,
                     const v1::StreamConfig& config);
  void ReadAll();
  // Joins the reading thread; how the stream ended.
  absl::Status Join();

  const OnResponse on_response_;
  grpc::ClientContext context_;
  std::unique_ptr<v1::ContactService::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ClassifyContactRequest,
                                           v1::ClassifyContactResponse>>
      rpc_;
  v1::ClassifyContactRequest end_of_trial_;
  std::thread reader_;
  // Written by the reading thread before it ends.
  absl::Status final_status_;

  std::mutex mutex_;
  std::condition_variable answered_;
  bool has_started_ = false;
  bool ended_ = false;
  v1::StreamStarted started_;
};

}  // namespace tactus::client
