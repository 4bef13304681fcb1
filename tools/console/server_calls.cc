#include "tools/console/server_calls.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/training/training_client.h"
#include "core/base/limits_console.h"

namespace tactus::internal::console {

ServerCalls::Call::Call(const std::string& token) {
  context_.set_deadline(std::chrono::system_clock::now() +
                        std::chrono::seconds(limits::kPageCallS));
  if (!token.empty()) {
    context_.AddMetadata("authorization", absl::StrCat("Bearer ", token));
  }
}

bool ServerCalls::Call::Go(bool ok) {
  if (step_ == Step::kFinish) {
    ReportEnd();
    return false;
  }
  if (!ok) {
    Finish();
    return true;
  }
  switch (step_) {
    case Step::kBegin:
      step_ = Step::kWrite;
      stream_->WriteLast(request_, grpc::WriteOptions(), this);
      break;
    case Step::kWrite:
      step_ = Step::kRead;
      stream_->Read(&message_, this);
      break;
    case Step::kRead:
      if (Keep()) {
        stream_->Read(&message_, this);
      } else {
        Cancel();
        Finish();
      }
      break;
    case Step::kFinish:
      break;
  }
  return true;
}

bool ServerCalls::Call::Keep() {
  bytes_ += message_.Length();
  messages_.push_back(message_);
  message_.Clear();
  return answer_ != PageAnswer::kFirst && bytes_ <= limits::kMaxPageReplyBytes;
}

void ServerCalls::Call::Finish() {
  step_ = Step::kFinish;
  stream_->Finish(&status_, this);
}

void ServerCalls::Call::ReportEnd() {
  Reply reply;
  if (bytes_ > limits::kMaxPageReplyBytes) {
    reply.status = absl::ResourceExhaustedError(absl::StrCat(
        "the server sends more than ", limits::kMaxPageReplyBytes, " bytes"));
  } else if (answer_ != PageAnswer::kFirst || messages_.empty()) {
    reply.status = client::TrainingClient::ErrorOf(
        status_, "the call", std::chrono::seconds(limits::kPageCallS));
  }
  reply.messages = std::move(messages_);
  // What it holds may hold this call.
  const Done done = std::exchange(done_, nullptr);
  done(std::move(reply));
}

ServerCalls::ServerCalls() : thread_([this] { Take(); }) {}

ServerCalls::~ServerCalls() { Stop(); }

void ServerCalls::Run(std::shared_ptr<Call> call,
                      const std::shared_ptr<grpc::Channel>& channel,
                      const std::string& path, PageAnswer answer,
                      const grpc::ByteBuffer& request, Done done) {
  const std::lock_guard lock(mutex_);
  // Nobody is left who could wait for it.
  if (stopped_) return;
  call->answer_ = answer;
  call->request_ = request;
  call->done_ = std::move(done);
  call->stream_ =
      grpc::GenericStub(channel).PrepareCall(&call->context_, path, &queue_);
  calls_.insert(call);
  call->stream_->StartCall(call.get());
}

void ServerCalls::Stop() {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    stopped_ = true;
    for (const auto& call : calls_) call->Cancel();
    if (calls_.empty()) queue_.Shutdown();
  }
  if (thread_.joinable()) thread_.join();
}

void ServerCalls::Take() {
  void* tag = nullptr;
  bool ok = false;
  while (queue_.Next(&tag, &ok)) {
    auto* call = static_cast<Call*>(tag);
    if (!call->Go(ok)) Forget(call);
  }
}

void ServerCalls::Forget(Call* call) {
  const std::lock_guard lock(mutex_);
  std::erase_if(calls_, [=](const auto& kept) { return kept.get() == call; });
  if (stopped_ && calls_.empty()) queue_.Shutdown();
}

}  // namespace tactus::internal::console
