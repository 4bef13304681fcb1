#include "server/session/stream_session.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/classify/input_spec.h"
#include "core/skin/layout_proto.h"
#include "server/session/fitting_models.h"
#include "server/session/request_parser.h"

namespace tactus::server {
namespace {

v1::Question QuestionToProto(const Question& question) {
  v1::Question out;
  out.set_name(question.name);
  out.set_kind(question.kind == Question::kState ? v1::Question::KIND_STATE
                                                 : v1::Question::KIND_PROPERTY);
  for (const std::string& value : question.values) out.add_values(value);
  for (const int value : question.value_of_class) {
    out.add_value_of_class(static_cast<uint32_t>(value));
  }
  return out;
}

}  // namespace

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
  if (pipeline_ == nullptr) MakePipeline();
  if (request.has_frames()) return OnFrames(request.frames());
  OnEndOfTrial();
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
  TACTUS_ASSIGN_OR_RETURN(PinnedModel pinned,
                          models_->Find(settings_.model, settings_.client_id));
  const absl::Status fits = ContactPipeline::Check(
      settings_.layout, *pinned.model, settings_.pipeline);
  if (!fits.ok()) return NameFittingModels(fits, pinned, settings_, *models_);
  pinned_ = std::move(pinned);
  decoder_.emplace(settings_);
  writer_.emplace(&settings_);
  rate_.emplace(settings_.pipeline.sample_rate_hz);
  WriteStarted();
  return absl::OkStatus();
}

void StreamSession::MakePipeline() {
  pipeline_ = std::make_unique<ContactPipeline>(
      settings_.layout, pinned_->model, settings_.pipeline);
}

void StreamSession::CheckForNewerModel() {
  generation_ = models_->generation();
  if (superseded_) return;
  const auto newest = models_->Find(settings_.model, settings_.client_id);
  superseded_ = newest.ok() && newest->version_name != pinned_->version_name;
  if (superseded_) {
    responses_.AddMessage()->mutable_notice()->set_kind(
        v1::StreamNotice::KIND_MODEL_SUPERSEDED);
  }
}

void StreamSession::WriteStarted() {
  const CompiledModel& compiled = *pinned_->model;
  const Model& model = compiled.model();
  v1::StreamStarted* started = responses_.AddMessage()->mutable_started();
  started->set_model_version(pinned_->version_name);
  started->set_bundle_sha256(pinned_->sha256);
  for (const std::string& name : model.class_names) {
    started->add_class_names(name);
  }
  for (const Question& question : compiled.questions()) {
    *started->add_questions() = QuestionToProto(question);
  }
  for (const Feature feature : FeaturesUsed(model.inputs)) {
    started->add_features(std::string(FeatureName(feature)));
  }
  started->set_stream_id(options_.stream_id);
  v1::StreamLimits* limits = started->mutable_limits();
  limits->set_max_frames_per_message(limits::kMaxFramesPerMessage);
  limits->set_max_message_bytes(limits::kMaxMessageBytes);
  limits->set_idle_timeout_ms(options_.idle_timeout_ms);
  limits->set_max_contacts(MostContacts(model, settings_.pipeline));
  started->mutable_server()->set_version(options_.server_version);
  started->mutable_server()->set_api("tactus.v1");
  *started->mutable_geometry() = LayoutToProto(settings_.layout);
  if (!model.layout.name.empty()) {
    *started->mutable_trained_geometry() = LayoutToProto(model.layout);
  }
  started->set_truth(model.truth == Truth::kSoFar ? v1::TRUTH_SO_FAR
                                                  : v1::TRUTH_FINAL);
}

absl::Status StreamSession::OnFrames(const v1::FrameBatch& batch) {
  TACTUS_RETURN_IF_ERROR(decoder_->Check(batch));
  // A trial may begin at any sequence number; only gaps within a trial count.
  const uint64_t missing =
      trial_frames_ == 0
          ? 0
          : batch.first_sequence() - decoder_->last_sequence() - 1;
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    OnFrame(batch, i, i == 0 ? missing : 0);
  }
  decoder_->Accept(batch);
  WatchRate(batch, missing);
  return absl::OkStatus();
}

void StreamSession::WatchRate(const v1::FrameBatch& batch, uint64_t missing) {
  if (!rate_->Add(batch.frame_count(), batch.first_capture_time_ns(),
                  missing)) {
    return;
  }
  v1::StreamNotice* notice = responses_.AddMessage()->mutable_notice();
  notice->set_kind(v1::StreamNotice::KIND_RATE_DIFFERS);
  notice->set_measured_rate_hz(rate_->measured_hz());
  notice->set_stated_rate_hz(rate_->stated_hz());
}

void StreamSession::OnFrame(const v1::FrameBatch& batch, uint32_t index,
                            uint64_t missing_before) {
  FrameView frame = decoder_->Frame(batch, index);
  frame.missing_before = missing_before;
  pipeline_->Step(frame);
  ++frames_;
  ++trial_frames_;
  writer_->OnFrame(*pipeline_, frame, batch.first_sequence() + index,
                   decoder_->CaptureTime(batch, index));
  const bool due = IsDue();
  if (writer_->has_events()) {
    writer_->Write(*pipeline_, false, responses_.AddKept());
  } else if (due) {
    writer_->Write(*pipeline_, false, responses_.AddInterim());
  }
}

std::string StreamSession::LogName() const {
  return absl::StrCat("stream ", options_.stream_id, " of client ",
                      Quoted(settings_.client_id));
}

SkipCounters StreamSession::skipped() const {
  SkipCounters skipped;
  if (pipeline_ == nullptr) return skipped;
  skipped = pipeline_->skipped();
  skipped[SkipRule::kUnlistedTaxels] = decoder_->sparse_frames();
  return skipped;
}

bool StreamSession::IsDue() {
  switch (settings_.cadence) {
    case v1::RESULT_CADENCE_EVERY_N_FRAMES:
      return trial_frames_ % settings_.result_interval_frames == 0;
    case v1::RESULT_CADENCE_ON_CHANGE:
      return HasChanged();
    case v1::RESULT_CADENCE_EVENTS:
      return false;
    default:
      return true;
  }
}

bool StreamSession::HasChanged() {
  std::array<Seen, limits::kMaxContacts> now = {};
  for (const ContactReport& contact : pipeline_->contacts()) {
    if (contact.released()) continue;
    now[contact.slot] = {contact.id, contact.classifier->best_class()};
  }
  return std::exchange(seen_, now) != now;
}

void StreamSession::OnEndOfTrial() {
  writer_->Write(*pipeline_, true, responses_.AddKept());
  pipeline_->EndTrial();
  writer_->OnEndOfTrial();
  rate_->Pause();
  trial_frames_ = 0;
  seen_ = {};
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
  v1::StreamNotice* notice = responses_.AddMessage()->mutable_notice();
  notice->set_kind(v1::StreamNotice::KIND_DRAINING);
  notice->set_grace_ms(grace_ms);
}

void StreamSession::Finish(absl::Status status) {
  if (finishing_) return;
  responses_.BeginRequest();
  if (trial_frames_ > 0) OnEndOfTrial();
  finishing_ = true;
  final_status_ = std::move(status);
}

}  // namespace tactus::server
