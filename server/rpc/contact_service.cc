#include "server/rpc/contact_service.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "spdlog/spdlog.h"

namespace tactus::server {

ContactService::ContactService(const ModelSource* models, Options options)
    : models_(models),
      options_(std::move(options)),
      gate_(options_.max_streams) {}

void ContactService::Serve(CallQueue* queue) {
  lanes_.try_emplace(queue);
  // Deletes itself.
  new ContactCall(this, queue, this);
  new TrialCall(this, queue, this);
}

absl::StatusOr<StreamSession::Options> ContactService::Admit(
    ContactCall* stream) {
  new ContactCall(this, stream->queue(), this);
  auto options = Enter();
  if (options.ok()) lanes_.at(stream->queue()).streams.insert(stream);
  return options;
}

absl::StatusOr<StreamSession::Options> ContactService::Admit(TrialCall* call) {
  new TrialCall(this, call->queue(), this);
  return Enter();
}

absl::StatusOr<StreamSession::Options> ContactService::Enter() {
  if (draining_) return Draining();
  if (!gate_.TryEnter()) return StreamLimit(gate_.limit());
  return StreamSession::Options{
      .stream_id = absl::StrCat(next_stream_.fetch_add(1)),
      .server_version = options_.server_version,
      .idle_timeout_ms = static_cast<uint32_t>(options_.idle_timeout_ms)};
}

void ContactService::Release(ContactCall* stream) {
  lanes_.at(stream->queue()).streams.erase(stream);
  Leave(stream->session());
}

void ContactService::Release(TrialCall* call) { Leave(call->session()); }

void ContactService::Leave(const StreamSession& session) {
  const uint64_t frames = session.frames();
  spdlog::debug("stream ended after {} frames, {} left", frames,
                gate_.live() - 1);
  skipped_.Add(session.skipped());
  const std::lock_guard lock(mutex_);
  gate_.Leave(frames);
  stream_done_.notify_all();
}

void ContactService::StartDraining(std::chrono::milliseconds grace) {
  draining_ = true;
  ForEachStream([grace](ContactCall* stream) { stream->Drain(grace.count()); });
}

void ContactService::EndStreams() {
  ForEachStream([](ContactCall* stream) { stream->End(Draining()); });
}

bool ContactService::WaitUntilEmpty(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return stream_done_.wait_for(lock, timeout,
                               [this] { return gate_.live() == 0; });
}

void ContactService::ForEachStream(std::function<void(ContactCall*)> visit) {
  for (auto& [queue, lane] : lanes_) {
    queue->Post([&streams = lane.streams, visit] {
      // A visit may end a stream, but never deletes it.
      for (ContactCall* stream : streams) visit(stream);
    });
  }
}

}  // namespace tactus::server
