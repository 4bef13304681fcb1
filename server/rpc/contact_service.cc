#include "server/rpc/contact_service.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "server/ops/clock.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

std::string Outcome(const absl::Status& status) {
  if (status.ok()) return "OK";
  return absl::StrCat(ReasonOf(status), ": ", status.message());
}

// Names the rate of a stream's frames if its config says another.
std::string OddRate(const StreamSession& session) {
  const RateWatch* rate = session.rate();
  if (rate == nullptr || !rate->differs()) return "";
  return absl::StrFormat(
      "; its frames came at %.4g Hz, but its config says %g Hz",
      rate->measured_hz(), rate->stated_hz());
}

}  // namespace

ContactService::ContactService(const ModelSource* models,
                               const Authorizer* authorizer, Options options)
    : models_(models),
      authorizer_(authorizer),
      options_(std::move(options)),
      gate_("streams", {.all = options_.max_streams,
                        .per_peer = options_.max_streams_per_peer}),
      clients_(options_.max_streams_per_client) {}

void ContactService::Serve(CallQueue* queue) {
  lanes_.try_emplace(queue);
  // Deletes itself.
  new ContactCall(this, queue, this);
  new TrialCall(this, queue, this);
}

absl::StatusOr<StreamSession::Options> ContactService::Admit(
    ContactCall* stream) {
  new ContactCall(this, stream->queue(), this);
  auto options =
      Enter(stream, stream->context(),
            "/tactus.v1.ContactService/ClassifyContact", stream->peer());
  if (options.ok()) lanes_.at(stream->queue()).streams.insert(stream);
  return options;
}

absl::StatusOr<StreamSession::Options> ContactService::Admit(TrialCall* call) {
  new TrialCall(this, call->queue(), this);
  return Enter(call, call->context(), "/tactus.v1.ContactService/ClassifyTrial",
               call->peer());
}

absl::StatusOr<StreamSession::Options> ContactService::Enter(
    const void* call, const grpc::ServerContext& context,
    absl::string_view method, const std::string& peer) {
  if (draining_) return Draining();
  TACTUS_ASSIGN_OR_RETURN(
      const Caller caller,
      authorizer_->Authorize(context, method, Role::kRobot));
  TACTUS_RETURN_IF_ERROR(clients_.Enter(call, caller.name));
  if (const absl::Status status = gate_.Enter(peer); !status.ok()) {
    clients_.Leave(call);
    return status;
  }
  return StreamSession::Options{
      .stream_id = absl::StrCat(next_stream_.fetch_add(1)),
      .server_version = options_.server_version,
      .idle_timeout_ms = static_cast<uint32_t>(options_.idle_timeout_ms)};
}

void ContactService::Release(ContactCall* stream) {
  lanes_.at(stream->queue()).streams.erase(stream);
  clients_.Leave(stream);
  Leave(stream->peer(), stream->session());
}

void ContactService::Release(TrialCall* call) {
  clients_.Leave(call);
  Leave(call->peer(), call->session());
}

void ContactService::Leave(const std::string& peer,
                           const StreamSession& session) {
  const uint64_t frames = session.frames();
  if (const auto left_out = stream_log_.Admit(MonotonicNs())) {
    spdlog::info("{} ended after {} frames: {}{}{}", session.LogName(), frames,
                 Outcome(session.final_status()), OddRate(session),
                 LeftOut(*left_out));
  }
  skipped_.Add(session.skipped());
  const std::lock_guard lock(mutex_);
  gate_.Leave(peer, frames);
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

}  // namespace tactus::internal::server
