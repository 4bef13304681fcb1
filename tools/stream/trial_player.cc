#include "tools/stream/trial_player.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/stream/answers.h"
#include "client/stream/skin_notice_text.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/trial_id.h"
#include "tools/common/rate_news.h"

namespace tactus::internal::client {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

int64_t NowNs() {
  return nanoseconds(steady_clock::now().time_since_epoch()).count();
}

}  // namespace

TrialPlayer::TrialPlayer(std::shared_ptr<grpc::Channel> channel,
                         LabelledDriver* driver, const Options& options,
                         OnTrial on_trial)
    : channel_(std::move(channel)),
      driver_(driver),
      options_(options),
      on_trial_(std::move(on_trial)) {}

absl::Status TrialPlayer::Run() {
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver_->Configure());
  TACTUS_RETURN_IF_ERROR(driver_->Activate());
  // Without trials there is no skin.
  if (info.layout.taxels() == 0) return driver_->Deactivate();
  encoder_.emplace(info, FrameEncoder::Options{.sparse = options_.sparse});
  v1::StreamConfig config = MakeConfig(info);
  config.set_model(options_.model);
  config.set_client_id(options_.client_id);
  config.set_with_diagnostics(true);
  TACTUS_ASSIGN_OR_RETURN(
      stream_, ResumableStream::Open(channel_, config,
                                     [this](const auto& r) { OnResponse(r); },
                                     {.timeouts = options_.timeouts,
                                      .token = options_.token,
                                      .resume_for = options_.resume_for}));
  const v1::StreamStarted& started = stream_->started();
  if (options_.recorder) options_.recorder->Begin(info, config, started);
  if (options_.check) options_.check->ReceiveModel(started.bundle_sha256());
  const auto& names = started.class_names();
  class_names_.assign(names.begin(), names.end());
  const absl::Status played = Play();
  totals_.rtt_us = std::move(rtt_us_);
  totals_.resumed = stream_->statistics().resumed;
  TACTUS_RETURN_IF_ERROR(played);
  TACTUS_RETURN_IF_ERROR(stream_->Close());
  return driver_->Deactivate();
}

absl::Status TrialPlayer::Play() {
  SkinFrame frame;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(frame));
    switch (result) {
      case ReadResult::kFrame:
        TACTUS_RETURN_IF_ERROR(PlayFrame(frame));
        break;
      case ReadResult::kEndOfTrial:
        TACTUS_RETURN_IF_ERROR(EndTrial());
        break;
      case ReadResult::kNoFrame:
        break;
      case ReadResult::kEndOfData:
        return absl::OkStatus();
    }
  }
}

void TrialPlayer::BeginTrial(const SkinFrame& frame) {
  in_trial_ = true;
  trial_start_ns_ = NowNs();
  trial_capture_ns_ = frame.capture_time_ns;
  if (options_.recorder) options_.recorder->BeginTrial(*driver_);
}

absl::Status TrialPlayer::PlayFrame(const SkinFrame& frame) {
  if (!in_trial_) BeginTrial(frame);
  if (options_.recorder) options_.recorder->Frame(frame);
  if (options_.real_time) {
    std::this_thread::sleep_until(steady_clock::time_point(nanoseconds(
        trial_start_ns_ + frame.capture_time_ns - trial_capture_ns_)));
  }
  if (frame.missing_before > 0) {
    TACTUS_RETURN_IF_ERROR(SendBatch());
    encoder_->Skip(frame.missing_before);
  }
  encoder_->Add(frame);
  ++totals_.frames;
  // Assumes that the next frame is about as large as those before it.
  const size_t frames = encoder_->frames();
  const size_t with_next = encoder_->bytes() * (frames + 1) / frames;
  const bool full =
      frames >= std::min(options_.batch, limits::kMaxFramesPerMessage) ||
      with_next > limits::kMaxMessageBytes * 3 / 4;
  return full ? SendBatch() : absl::OkStatus();
}

absl::Status TrialPlayer::SendBatch() {
  if (encoder_->frames() == 0) return absl::OkStatus();
  const uint64_t sequence = encoder_->last_sequence();
  {
    const std::lock_guard lock(mutex_);
    sent_sequence_ = sequence;
    sent_ns_ = NowNs();
  }
  TACTUS_RETURN_IF_ERROR(stream_->Send(encoder_->request()));
  encoder_->Clear();
  if (options_.real_time) return absl::OkStatus();
  return AwaitAnswer(sequence);
}

absl::Status TrialPlayer::EndTrial() {
  TACTUS_RETURN_IF_ERROR(SendBatch());
  if (options_.recorder) options_.recorder->EndTrial();
  TACTUS_ASSIGN_OR_RETURN(const v1::Answer answer, stream_->EndTrial());
  in_trial_ = false;
  {
    const std::lock_guard lock(mutex_);
    const uint64_t accounted =
        std::min(totals_.frames, answers_ + answer.superseded());
    totals_.lost = totals_.frames - accounted;
  }
  TACTUS_ASSIGN_OR_RETURN(const TrialResult result, Result(answer));
  on_trial_(result);
  return absl::OkStatus();
}

absl::StatusOr<TrialResult> TrialPlayer::Result(
    const v1::Answer& answer) const {
  const Trial& trial = driver_->trial();
  TrialResult result;
  const auto label =
      std::find(class_names_.begin(), class_names_.end(), trial.label);
  if (label == class_names_.end()) {
    return InvalidConfig(absl::StrCat("label of trial ", trial.id), trial.label,
                         "one of " + absl::StrJoin(class_names_, ", "));
  }
  result.index = driver_->trial_index();
  result.id = TrialName(trial.id, trial.source);
  result.label = static_cast<int>(label - class_names_.begin());
  const v1::Contact* contact = MainContact(answer);
  result.detected = contact != nullptr;
  if (!result.detected) return result;
  const auto& p = contact->probability();
  result.probability.assign(p.begin(), p.end());
  result.answer = BestClass(*contact);
  const auto& scores = answer.diagnostics().contacts(0).log_likelihood();
  result.log_likelihood.assign(scores.begin(), scores.end());
  if (const auto decided = DecidedClassOf(stream_->started(), *contact)) {
    result.decision = decided->class_index;
    result.decision_ms =
        static_cast<double>(decided->time_since_onset_ns) / 1e6;
  }
  return result;
}

void TrialPlayer::OnResponse(const v1::ClassifyContactResponse& response) {
  const int64_t now_ns = NowNs();
  if (response.notice().kind() == v1::StreamNotice::KIND_RATE_DIFFERS) {
    const std::lock_guard lock(mutex_);
    totals_.rate_news = RateNews(response.notice().measured_rate_hz(),
                                 response.notice().stated_rate_hz());
  }
  if (response.notice().kind() == v1::StreamNotice::KIND_SKIN_DIFFERS) {
    const std::lock_guard lock(mutex_);
    totals_.skin_news = SkinNoticeText(response.notice());
  }
  if (!response.has_answer()) return;
  const v1::Answer& answer = response.answer();
  if (options_.recorder) options_.recorder->Result(answer);
  if (options_.check) options_.check->Receive(answer);
  if (answer.is_final()) return;
  const std::lock_guard lock(mutex_);
  ++answers_;
  last_answer_ = answer.sequence();
  if (last_answer_ == sent_sequence_) {
    rtt_us_.push_back(static_cast<double>(now_ns - sent_ns_) / 1e3);
  }
  answered_.notify_one();
}

absl::Status TrialPlayer::AwaitAnswer(uint64_t sequence) {
  const auto limit = options_.timeouts.final_answer;
  auto deadline = steady_clock::now() + limit;
  const auto is_answered = [&] { return last_answer_ >= sequence; };
  std::unique_lock lock(mutex_);
  while (
      !answered_.wait_for(lock, std::chrono::milliseconds(100), is_answered)) {
    if (stream_->ended()) {
      if (is_answered()) break;
      lock.unlock();
      const absl::Status status = stream_->Close();
      return status.ok() ? StreamFinished() : status;
    }
    // A lost stream has another limit.
    if (stream_->resuming()) deadline = steady_clock::now() + limit;
    if (limit.count() > 0 && steady_clock::now() > deadline) {
      stream_->Cancel();
      return NoResponse("frames", limit.count());
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
