#include "client/front/local_stream.h"

#include <atomic>
#include <utility>

#include "client/front/answer_delivery.h"
#include "client/front/skin_convert.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/stream/contact_session.h"
#include "core/stream/stream_started.h"

namespace tactus::internal::client {
namespace {

class LocalStream : public Stream, private AnswerSink {
 public:
  LocalStream(const LocalModel& model, const SkinInfo& skin,
              const StreamSettings& settings, const StreamOptions& options)
      : skin_(skin),
        delivery_(options),
        encoder_(skin, {}),
        session_(settings, model.model, this) {
    v1::StreamStarted started;
    WriteStarted(settings, *model.model, &started);
    started.set_model_version(model.version);
    started.set_bundle_sha256(model.sha256);
    delivery_.Begin(started);
  }

  const StreamInfo& info() const override {
    return delivery_.converter().info();
  }

  absl::Status Push(const Frame& frame) override {
    TACTUS_RETURN_IF_ERROR(Refusal());
    TACTUS_RETURN_IF_ERROR(ToSkinFrame(frame, skin_, frame_));
    encoder_.Clear();
    encoder_.Skip(frame.missing_before);
    encoder_.Add(frame_);
    const absl::Status status = session_.OnFrames(encoder_.request().frames());
    Deliver();
    ++frames_;
    return status.ok() ? status : End(status);
  }

  absl::StatusOr<Answer> EndTrial() override {
    TACTUS_RETURN_IF_ERROR(Refusal());
    session_.OnEndOfTrial();
    Deliver();
    Answer answer;
    delivery_.converter().Convert(answer_, answer);
    return answer;
  }

  absl::Status Close() override {
    if (!ended_ && !is_cancelled_) {
      if (session_.trial_open()) session_.OnEndOfTrial();
      Deliver();
      End(absl::OkStatus()).IgnoreError();
    }
    const absl::Status refusal = Refusal();
    return ReasonOf(refusal) == "STREAM_FINISHED" ? absl::OkStatus() : refusal;
  }

  bool Poll(Event& event) override { return delivery_.events().Poll(event); }
  bool ended() override { return ended_ || is_cancelled_; }
  bool resuming() override { return false; }
  void Cancel() override { is_cancelled_ = true; }

  StreamStatistics statistics() override {
    StreamStatistics statistics;
    statistics.frames = frames_;
    statistics.events_dropped = delivery_.events().dropped();
    return statistics;
  }

 private:
  v1::Answer* AddInterim() override { return AddKept(); }
  v1::Answer* AddKept() override {
    has_answer_ = true;
    return &answer_;
  }
  v1::StreamNotice* AddNotice() override {
    has_notice_ = true;
    notice_.Clear();
    return &notice_;
  }

  // There is at most one answer a frame.
  void Deliver() {
    if (std::exchange(has_answer_, false)) delivery_.OnAnswer(answer_);
    if (std::exchange(has_notice_, false)) delivery_.OnNotice(notice_);
  }

  // Why a call fails; OK while the stream goes on.
  absl::Status Refusal() const {
    if (ended_) return end_.ok() ? StreamFinished() : end_;
    return is_cancelled_ ? WorkCancelled("the stream") : absl::OkStatus();
  }
  absl::Status End(const absl::Status& status) {
    end_ = status;
    ended_ = true;
    return status;
  }

  const SkinInfo skin_;
  AnswerDelivery delivery_;
  FrameEncoder encoder_;
  SkinFrame frame_;
  ContactSession session_;
  v1::Answer answer_;
  v1::StreamNotice notice_;
  bool has_answer_ = false;
  bool has_notice_ = false;
  std::atomic<uint64_t> frames_ = 0;
  // Written by the thread that pushes, before ended_.
  absl::Status end_;
  std::atomic<bool> ended_ = false;
  std::atomic<bool> is_cancelled_ = false;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Stream>> OpenLocalStream(
    const LocalModel& model, const Skin& skin, const StreamOptions& options) {
  if (!options.model.empty()) {
    return InvalidConfig("model", Quoted(options.model),
                         "empty: the file that was loaded is the model");
  }
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, ToSkinInfo(skin));
  TACTUS_ASSIGN_OR_RETURN(const v1::StreamConfig config,
                          ToConfig(info, options));
  TACTUS_ASSIGN_OR_RETURN(const StreamSettings settings,
                          ParseStreamConfig(config));
  TACTUS_RETURN_IF_ERROR(
      ContactPipeline::Check(settings.layout, *model.model, settings.pipeline));
  return std::make_unique<LocalStream>(model, info, settings, options);
}

}  // namespace tactus::internal::client
