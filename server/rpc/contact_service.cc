#include "server/rpc/contact_service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "server/rpc/status.h"
#include "spdlog/spdlog.h"

namespace tactus::server {

ContactService::ContactService(const ModelSource* models, Options options)
    : models_(models),
      options_(std::move(options)),
      gate_(options_.max_streams) {}

BytesReactor* ContactService::ClassifyContact(
    grpc::CallbackServerContext* context) {
  std::unique_lock lock(mutex_);
  if (draining_) return RefuseStream(Draining());
  if (!gate_.TryEnter()) return RefuseStream(StreamLimit(gate_.limit()));
  ContactStream::Options options;
  options.session.stream_id = absl::StrCat(next_stream_.fetch_add(1));
  options.session.server_version = options_.server_version;
  options.session.idle_timeout_ms = options_.idle_timeout_ms;
  options.idle_timeout_ms = options_.idle_timeout_ms;
  options.on_done = [this](ContactStream* stream) { OnStreamDone(stream); };
  auto stream =
      std::make_shared<ContactStream>(context, models_, std::move(options));
  streams_.insert(stream);
  lock.unlock();
  stream->Start();
  return stream.get();
}

grpc::ServerUnaryReactor* ContactService::ClassifyTrial(
    grpc::CallbackServerContext* context, const v1::ClassifyTrialRequest*,
    v1::ClassifyTrialResponse*) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(
      ToGrpcStatus(Unimplemented("/tactus.v1.ContactService/ClassifyTrial")));
  return reactor;
}

void ContactService::StartDraining(std::chrono::milliseconds grace) {
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
  }
  for (const auto& stream : Streams()) stream->Drain(grace.count());
}

void ContactService::EndStreams() {
  for (const auto& stream : Streams()) stream->End(Draining());
}

bool ContactService::WaitUntilEmpty(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return stream_done_.wait_for(lock, timeout,
                               [this] { return streams_.empty(); });
}

std::vector<std::shared_ptr<ContactStream>> ContactService::Streams() {
  const std::lock_guard lock(mutex_);
  return {streams_.begin(), streams_.end()};
}

void ContactService::OnStreamDone(ContactStream* stream) {
  const uint64_t frames = stream->frames();
  spdlog::debug("stream ended after {} frames, {} left", frames,
                gate_.live() - 1);
  skipped_.Add(stream->skipped());
  const std::lock_guard lock(mutex_);
  streams_.erase(stream->shared_from_this());
  gate_.Leave(frames);
  stream_done_.notify_all();
}

}  // namespace tactus::server
