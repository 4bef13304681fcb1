#include "client/stream/contact_stream.h"

#include <utility>

#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {

absl::StatusOr<std::unique_ptr<ContactStream>> ContactStream::Open(
    const std::shared_ptr<grpc::Channel>& channel,
    const v1::StreamConfig& config, OnResponse on_response) {
  std::unique_ptr<ContactStream> stream(
      new ContactStream(std::move(on_response)));
  TACTUS_RETURN_IF_ERROR(stream->Begin(channel, config));
  return stream;
}

absl::Status ContactStream::Begin(const std::shared_ptr<grpc::Channel>& channel,
                                  const v1::StreamConfig& config) {
  end_of_trial_.mutable_end_of_trial();
  stub_ = v1::ContactService::NewStub(channel);
  rpc_ = stub_->ClassifyContact(&context_);
  reader_ = std::thread([this] { ReadAll(); });
  v1::ClassifyContactRequest request;
  *request.mutable_config() = config;
  // If this fails the reader learns why.
  rpc_->Write(request);
  {
    std::unique_lock lock(mutex_);
    answered_.wait(lock, [this] { return has_started_ || ended_; });
    if (has_started_) return absl::OkStatus();
  }
  return Join();
}

ContactStream::~ContactStream() {
  if (!reader_.joinable()) return;
  Cancel();
  reader_.join();
}

void ContactStream::ReadAll() {
  v1::ClassifyContactResponse response;
  while (rpc_->Read(&response)) {
    if (response.has_started()) {
      const std::lock_guard lock(mutex_);
      started_ = response.started();
      has_started_ = true;
      answered_.notify_all();
    } else {
      on_response_(response);
    }
  }
  final_status_ = FromGrpcStatus(rpc_->Finish());
  const std::lock_guard lock(mutex_);
  ended_ = true;
  answered_.notify_all();
}

absl::Status ContactStream::Send(const v1::ClassifyContactRequest& request) {
  if (!reader_.joinable()) return StreamFinished();
  // gRPC may go on taking messages for a stream that the server has ended.
  if (!ended() && rpc_->Write(request)) return absl::OkStatus();
  const absl::Status status = Join();
  return status.ok() ? StreamFinished() : status;
}

absl::Status ContactStream::EndTrial() { return Send(end_of_trial_); }

absl::Status ContactStream::Close() {
  if (!reader_.joinable()) return StreamFinished();
  rpc_->WritesDone();
  return Join();
}

bool ContactStream::ended() {
  const std::lock_guard lock(mutex_);
  return ended_;
}

absl::Status ContactStream::Join() {
  reader_.join();
  return final_status_;
}

}  // namespace tactus::client
