#include "core/stream/contact_session.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/stream/skin_notice.h"

namespace tactus::internal {

ContactSession::ContactSession(const StreamSettings& settings,
                               std::shared_ptr<const CompiledModel> model,
                               AnswerSink* sink)
    : settings_(settings),
      model_(std::move(model)),
      sink_(sink),
      decoder_(settings_),
      writer_(&settings_),
      rate_(settings_.pipeline.sample_rate_hz) {
  const auto& range = model_->model().skin_range;
  const auto taxels = static_cast<size_t>(settings_.layout.taxels());
  if (range && range->most.size() == taxels) skin_watch_.emplace(&*range);
}

ContactPipeline& ContactSession::Pipeline() {
  if (pipeline_ == nullptr) {
    pipeline_ = std::make_unique<ContactPipeline>(settings_.layout, model_,
                                                  settings_.pipeline);
  }
  return *pipeline_;
}

absl::Status ContactSession::OnFrames(const v1::FrameBatch& batch) {
  TACTUS_RETURN_IF_ERROR(decoder_.Check(batch));
  // A trial may begin at any sequence number; only gaps within a trial count.
  const uint64_t missing =
      trial_frames_ == 0
          ? 0
          : batch.first_sequence() - decoder_.last_sequence() - 1;
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    OnFrame(batch, i, i == 0 ? missing : 0);
  }
  decoder_.Accept(batch);
  WatchRate(batch, missing);
  return absl::OkStatus();
}

void ContactSession::WatchRate(const v1::FrameBatch& batch, uint64_t missing) {
  if (!rate_.Add(batch.frame_count(), batch.first_capture_time_ns(), missing)) {
    return;
  }
  v1::StreamNotice* notice = sink_->AddNotice();
  notice->set_kind(v1::StreamNotice::KIND_RATE_DIFFERS);
  notice->set_measured_rate_hz(rate_.measured_hz());
  notice->set_stated_rate_hz(rate_.stated_hz());
}

void ContactSession::WatchSkin() {
  // A model that sees all taxels follows one contact, which has them all.
  for (const ContactReport& contact : pipeline_->contacts()) {
    if (contact.released()) {
      if (skin_watch_->EndContact()) {
        WriteSkinNotice(*model_->model().skin_range, *skin_watch_,
                        sink_->AddNotice());
      }
    } else if (contact.features->touched) {
      skin_watch_->Step(contact.features->loads);
    }
  }
}

void ContactSession::OnFrame(const v1::FrameBatch& batch, uint32_t index,
                             uint64_t missing_before) {
  FrameView frame = decoder_.Frame(batch, index);
  frame.missing_before = missing_before;
  ContactPipeline& pipeline = Pipeline();
  pipeline.Step(frame);
  if (skin_watch_) WatchSkin();
  ++frames_;
  ++trial_frames_;
  frames_missing_ += missing_before;
  writer_.OnFrame(pipeline, frame, batch.first_sequence() + index,
                  decoder_.CaptureTime(batch, index));
  const bool due = IsDue();
  if (writer_.has_events()) {
    writer_.Write(pipeline, false, sink_->AddKept());
  } else if (due) {
    writer_.Write(pipeline, false, sink_->AddInterim());
  }
  if (tap_ == nullptr) return;
  if (v1::Answer* seen = tap_->Want(writer_.has_events())) {
    writer_.Write(pipeline, false, /*with_taxels=*/true, seen);
    tap_->Take(frame, *seen);
  }
}

int ContactSession::contacts_now() const {
  if (pipeline_ == nullptr) return 0;
  return static_cast<int>(std::ranges::count_if(
      pipeline_->contacts(), std::not_fn(&ContactReport::released)));
}

SkipCounters ContactSession::skipped() const {
  SkipCounters skipped;
  if (pipeline_ == nullptr) return skipped;
  skipped = pipeline_->skipped();
  skipped[SkipRule::kUnlistedTaxels] = decoder_.sparse_frames();
  return skipped;
}

bool ContactSession::IsDue() {
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

bool ContactSession::HasChanged() {
  std::array<Seen, limits::kMaxContacts> now = {};
  for (const ContactReport& contact : pipeline_->contacts()) {
    if (contact.released()) continue;
    now[contact.slot] = {contact.id, contact.classifier->best_class()};
  }
  return std::exchange(seen_, now) != now;
}

void ContactSession::OnEndOfTrial() {
  writer_.Write(Pipeline(), true, sink_->AddKept());
  if (tap_ != nullptr) {
    if (v1::Answer* seen = tap_->Want(/*has_events=*/true)) {
      writer_.Write(Pipeline(), true, /*with_taxels=*/true, seen);
      tap_->Take({}, *seen);
    }
  }
  if (skin_watch_ && skin_watch_->EndContact()) {
    WriteSkinNotice(*model_->model().skin_range, *skin_watch_,
                    sink_->AddNotice());
  }
  Pipeline().EndTrial();
  writer_.OnEndOfTrial();
  rate_.Pause();
  trial_frames_ = 0;
  seen_ = {};
}

}  // namespace tactus::internal
