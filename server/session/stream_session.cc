#include "server/session/stream_session.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/stream/stream_started.h"
#include "server/session/fitting_models.h"
#include "server/session/request_parser.h"

namespace tactus::internal::server {
StreamSession::StreamSession(const ModelSource* models, Options options)
    : models_(models), options_(std::move(options)) {}

StreamSession::State StreamSession::state() const {
  if (finishing_) return responses_.empty() ? State::kDone : State::kFinishing;
  return pinned_ ? State::kStreaming : State::kWaitConfig;
}

absl::Status StreamSession::OnMessage(
    google::protobuf::io::ZeroCopyInputStream* bytes, size_t size,
    v1::ClassifyContactRequest* request) {
  // A message that is too large is refused before it is parsed.
  if (!finishing_ && size > limits::kMaxMessageBytes) {
    return EndIfError(MessageTooLarge(size, limits::kMaxMessageBytes));
  }
  if (!finishing_ && !ParseRequest(bytes, request)) {
    return EndIfError(MalformedRequest(size));
  }
  return Take(*request);
}

absl::Status StreamSession::OnRequest(
    const v1::ClassifyContactRequest& request) {
  const size_t size = request.ByteSizeLong();
  if (!finishing_ && size > limits::kMaxMessageBytes) {
    return EndIfError(MessageTooLarge(size, limits::kMaxMessageBytes));
  }
  return Take(request);
}

absl::Status StreamSession::Take(const v1::ClassifyContactRequest& request) {
  if (finishing_) return StreamFinished();
  responses_.BeginRequest();
  if (pinned_ && models_->generation() != generation_) CheckForNewerModel();
  return EndIfError(Dispatch(request));
}

absl::Status StreamSession::EndIfError(absl::Status status) {
  if (!status.ok()) {
    finishing_ = true;
    final_status_ = status;
  }
  return status;
}

absl::Status StreamSession::Dispatch(
    const v1::ClassifyContactRequest& request) {
  if (request.request_case() == v1::ClassifyContactRequest::REQUEST_NOT_SET) {
    return EmptyRequest();
  }
  if (request.has_config()) return OnConfig(request.config());
  if (!pinned_) return ConfigRequired();
  if (request.has_frames()) return contacts_->OnFrames(request.frames());
  contacts_->OnEndOfTrial();
  return absl::OkStatus();
}

void StreamSession::EndRequest(int64_t start_ns, int64_t now_ns) {
  responses_.EndRequest(now_ns - start_ns, now_ns);
}

absl::Status StreamSession::OnConfig(const v1::StreamConfig& config) {
  if (pinned_) return ConfigRepeated();
  TACTUS_ASSIGN_OR_RETURN(settings_, ParseStreamConfig(config));
  // Before Find: a version added in between is then found by the next message.
  generation_ = models_->generation();
  TACTUS_ASSIGN_OR_RETURN(PinnedModel pinned, FindModel(*models_, settings_));
  pinned_ = std::move(pinned);
  config_ = config;
  contacts_.emplace(settings_, pinned_->model, &responses_);
  WriteStarted(responses_.AddMessage()->mutable_started());
  return absl::OkStatus();
}

void StreamSession::CheckForNewerModel() {
  generation_ = models_->generation();
  if (superseded_) return;
  const auto newest = models_->Find(settings_.model, settings_.client_id);
  superseded_ = newest.ok() && newest->version_name != pinned_->version_name;
  if (superseded_) {
    responses_.AddNotice()->set_kind(v1::StreamNotice::KIND_MODEL_SUPERSEDED);
  }
}

void StreamSession::Describe(v1::OpenStream* stream) const {
  stream->set_stream_id(options_.stream_id);
  stream->set_client_id(settings_.client_id);
  stream->set_caller(options_.caller);
  stream->set_sample_rate_hz(settings_.pipeline.sample_rate_hz);
  WriteStarted(stream->mutable_started());
}

void StreamSession::WriteStarted(v1::StreamStarted* started) const {
  tactus::internal::WriteStarted(settings_, *pinned_->model, started);
  started->set_model_version(pinned_->version_name);
  started->set_bundle_sha256(pinned_->sha256);
  started->set_stream_id(options_.stream_id);
  started->mutable_limits()->set_idle_timeout_ms(options_.idle_timeout_ms);
  started->mutable_server()->set_version(options_.server_version);
  started->mutable_server()->set_api("tactus.v1");
}

std::string StreamSession::LogName() const {
  return absl::StrCat("stream ", options_.stream_id, " of client ",
                      Quoted(settings_.client_id));
}

void StreamSession::OnHalfClose() {
  Finish(pinned_ ? absl::OkStatus() : ConfigRequired());
}

void StreamSession::OnDraining(uint32_t grace_ms) {
  if (finishing_) return;
  if (!pinned_) {
    Finish(Draining());
    return;
  }
  v1::StreamNotice* notice = responses_.AddNotice();
  notice->set_kind(v1::StreamNotice::KIND_DRAINING);
  notice->set_grace_ms(grace_ms);
}

void StreamSession::Finish(absl::Status status) {
  if (finishing_) return;
  responses_.BeginRequest();
  if (contacts_ && contacts_->trial_open()) contacts_->OnEndOfTrial();
  finishing_ = true;
  final_status_ = std::move(status);
}

}  // namespace tactus::internal::server
