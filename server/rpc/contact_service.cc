#include "server/rpc/contact_service.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "server/ops/clock.h"
#include "server/records/caller.h"
#include "server/rpc/stream_families.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

std::string Outcome(const absl::Status& status, bool delivered) {
  if (status.ok()) return delivered ? "OK" : "the client was gone";
  return absl::StrCat(ReasonOf(status), ": ", status.message());
}

// What was lost and felt, if anything was.
std::string Counts(const ContactSession* contacts) {
  if (contacts == nullptr) return "";
  return absl::StrCat(" (", contacts->frames_missing(), " lost) and ",
                      contacts->contacts_begun(), " contacts");
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
                               const Authorizer* authorizer,
                               ServerMetrics* metrics, Options options)
    : models_(models),
      authorizer_(authorizer),
      metrics_(metrics),
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
      Enter(stream, stream->context(), ContactCall::kMethod, stream->peer());
  if (options.ok()) lanes_.at(stream->queue()).streams.insert(stream);
  return options;
}

absl::StatusOr<StreamSession::Options> ContactService::Admit(TrialCall* call) {
  new TrialCall(this, call->queue(), this);
  return Enter(call, call->context(), TrialCall::kMethod, call->peer());
}

absl::StatusOr<StreamSession::Options> ContactService::Enter(
    const void* call, const grpc::ServerContext& context,
    absl::string_view method, const std::string& peer) {
  auto options = TryToEnter(call, context, method, peer);
  if (!options.ok()) {
    metrics_->refused_streams.Add(ReasonOf(options.status()));
  }
  return options;
}

absl::StatusOr<StreamSession::Options> ContactService::TryToEnter(
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
      .caller = caller.name,
      .idle_timeout_ms = static_cast<uint32_t>(options_.idle_timeout_ms)};
}

ContactCall::Observers ContactService::Open(ContactCall* stream) {
  v1::OpenStream description;
  stream->session().Describe(&description);
  description.set_peer(stream->peer());
  description.set_start_time_ms(SystemNowMs());
  if (const auto left_out = stream_log_.Admit(MonotonicNs())) {
    spdlog::info("{} began: {} ({}), {}{}", stream->session().LogName(),
                 description.caller(), description.peer(),
                 description.started().model_version(), LeftOut(*left_out));
  }
  ContactCall::Observers observers;
  observers.series = metrics_->answers.SeriesOf(description.started());
  if (options_.contact_log != nullptr) {
    v1::RecordedStream recorded;
    *recorded.mutable_config() = stream->session().config();
    *recorded.mutable_started() = description.started();
    recorded.set_caller(description.caller());
    recorded.set_peer(description.peer());
    observers.recorder = options_.contact_log->Record(std::move(recorded));
  }
  observers.watched = open_streams_.Add(std::move(description)).get();
  return observers;
}

void ContactService::Release(ContactCall* stream) {
  if (stream->watched() != nullptr) open_streams_.Remove(stream->watched());
  lanes_.at(stream->queue()).streams.erase(stream);
  clients_.Leave(stream);
  Leave(stream->peer(), stream->session(), stream->delivered());
}

void ContactService::Release(TrialCall* call) {
  clients_.Leave(call);
  Leave(call->peer(), call->session(), call->delivered());
}

void ContactService::Leave(const std::string& peer,
                           const StreamSession& session, bool delivered) {
  const uint64_t frames = session.frames();
  if (const auto left_out = stream_log_.Admit(MonotonicNs())) {
    spdlog::info("{} ended after {} frames{}: {}{}{}", session.LogName(),
                 frames, Counts(session.contacts()),
                 Outcome(session.final_status(), delivered), OddRate(session),
                 LeftOut(*left_out));
  }
  skipped_.Add(session.skipped());
  const std::lock_guard lock(mutex_);
  gate_.Leave(peer, frames);
  stream_done_.notify_all();
}

void ContactService::Collect(Families* families) const {
  std::vector<const LaneMetrics*> lanes;
  for (const auto& [queue, lane] : lanes_) lanes.push_back(&lane.metrics);
  CollectStreams(lanes, gate_, skipped_, families);
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
