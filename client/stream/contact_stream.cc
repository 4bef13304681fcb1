#include "client/stream/contact_stream.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/stream/robot_id.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// Bounds the calls of one scope.
class Watch {
 public:
  Watch(Watchdog* watchdog, const char* what, std::chrono::milliseconds timeout)
      : watchdog_(watchdog) {
    watchdog_->Start(what, timeout);
  }
  ~Watch() { watchdog_->Stop(); }

  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  Watchdog* const watchdog_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ContactStream>> ContactStream::Open(
    const std::shared_ptr<grpc::Channel>& channel,
    const v1::StreamConfig& config, OnResponse on_response,
    const StreamTimeouts& timeouts, const std::string& token, OnEnd on_end) {
  std::unique_ptr<ContactStream> stream(
      new ContactStream(std::move(on_response), std::move(on_end), timeouts));
  if (!token.empty()) {
    stream->context_.AddMetadata("authorization",
                                 absl::StrCat("Bearer ", token));
  }
  if (IsRobotId(config.client_id())) {
    stream->context_.AddMetadata(kRobotIdKey, config.client_id());
  }
  TACTUS_RETURN_IF_ERROR(stream->Begin(channel, config));
  return stream;
}

ContactStream::ContactStream(OnResponse on_response, OnEnd on_end,
                             const StreamTimeouts& timeouts)
    : on_response_(std::move(on_response)),
      on_end_(std::move(on_end)),
      timeouts_(timeouts) {
  end_of_trial_.mutable_end_of_trial();
}

absl::Status ContactStream::Begin(const std::shared_ptr<grpc::Channel>& channel,
                                  const v1::StreamConfig& config) {
  const Watch watch(&watchdog_, "config", timeouts_.open);
  stub_ = v1::ContactService::NewStub(channel);
  // Waits for the connection.
  rpc_ = stub_->ClassifyContact(&context_);
  reader_ = std::thread([this] { ReadAll(); });
  v1::ClassifyContactRequest request;
  *request.mutable_config() = config;
  // If this fails, the reading thread learns why.
  rpc_->Write(request);
  {
    std::unique_lock lock(mutex_);
    answered_.wait(lock, [this] { return has_started_ || ended_; });
    if (has_started_) return absl::OkStatus();
  }
  const absl::Status status = Join();
  if (!status.ok()) return status;
  return InvalidResponse("end of the stream", "OK before `started`",
                         "`started` or an error");
}

ContactStream::~ContactStream() {
  if (!reader_.joinable()) return;
  Cancel();
  reader_.join();
}

void ContactStream::ReadAll() {
  v1::ClassifyContactResponse response;
  absl::Status invalid;
  while (rpc_->Read(&response)) {
    // After an invalid response the rest is read and dropped.
    if (!invalid.ok()) continue;
    invalid = checker_.Check(response);
    if (invalid.ok()) {
      OnChecked(response);
    } else {
      Cancel();
    }
  }
  final_status_ = FromGrpcStatus(rpc_->Finish());
  if (!invalid.ok()) final_status_ = invalid;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    answered_.notify_all();
  }
  if (on_end_) on_end_();
}

void ContactStream::OnChecked(const v1::ClassifyContactResponse& response) {
  if (response.has_started()) {
    const std::lock_guard lock(mutex_);
    started_ = response.started();
    has_started_ = true;
    answered_.notify_all();
    return;
  }
  on_response_(response);
  if (!response.answer().is_final()) return;
  const std::lock_guard lock(mutex_);
  final_ = response.answer();
  ++finals_;
  answered_.notify_all();
}

absl::Status ContactStream::Send(const v1::ClassifyContactRequest& request) {
  const Watch watch(&watchdog_, "a request", timeouts_.send);
  return Write(request);
}

absl::Status ContactStream::Write(const v1::ClassifyContactRequest& request) {
  // gRPC may accept messages for a stream that the server has ended.
  if (reader_.joinable() && !ended()) {
    if (request.has_end_of_trial()) ++trials_ended_;
    checker_.OnSent(request);
    if (rpc_->Write(request)) return absl::OkStatus();
  }
  const absl::Status status = Join();
  return status.ok() ? StreamFinished() : status;
}

absl::StatusOr<v1::Answer> ContactStream::EndTrial() {
  const Watch watch(&watchdog_, "end_of_trial", timeouts_.final_answer);
  TACTUS_RETURN_IF_ERROR(Write(end_of_trial_));
  {
    std::unique_lock lock(mutex_);
    answered_.wait(lock, [this] { return finals_ >= trials_ended_ || ended_; });
    if (finals_ >= trials_ended_) return final_;
  }
  const absl::Status status = Join();
  return status.ok() ? StreamFinished() : status;
}

absl::Status ContactStream::Close() {
  if (!reader_.joinable()) return final_status_;
  const Watch watch(&watchdog_, "the end of the stream", timeouts_.close);
  rpc_->WritesDone();
  return Join();
}

bool ContactStream::ended() {
  const std::lock_guard lock(mutex_);
  return ended_;
}

absl::Status ContactStream::Join() {
  if (!reader_.joinable()) return final_status_;
  reader_.join();
  if (absl::IsCancelled(final_status_)) {
    const absl::Status expiry = watchdog_.status();
    if (!expiry.ok()) final_status_ = expiry;
  }
  return final_status_;
}

}  // namespace tactus::internal::client
