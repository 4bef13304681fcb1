// File: contact_session.h
//
// ContactSession: the frames of one skin in, its answers out. It is what a
// server does between the configuration of a stream and its end, and what a
// program does that needs no server, so their answers have the same bits.
//
//   ContactSession session(settings, model, &sink);
//   TACTUS_RETURN_IF_ERROR(session.OnFrames(batch));
//   session.OnEndOfTrial();
//
// A batch is checked whole before any of its frames is used. Allocates nothing
// once the answers have grown to their size. No threads, no clock. Not
// thread-safe: one per stream.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "core/base/limits.h"
#include "core/base/rate_watch.h"
#include "core/classify/contact_pipeline.h"
#include "core/stream/answer_sink.h"
#include "core/stream/answer_writer.h"
#include "core/stream/frame_decoder.h"
#include "core/stream/stream_settings.h"
#include "core/stream/stream_tap.h"
#include "core/taxels/skin_range.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class ContactSession {
 public:
  // ContactPipeline::Check has accepted settings and model. `sink` must outlive
  // the session.
  ContactSession(const StreamSettings& settings,
                 std::shared_ptr<const CompiledModel> model, AnswerSink* sink);

  ContactSession(const ContactSession&) = delete;
  ContactSession& operator=(const ContactSession&) = delete;

  // Shows frames and answers to `tap` from now on, which must outlive the
  // session; null for nobody. What the session answers stays the same.
  void SetTap(StreamTap* tap) { tap_ = tap; }

  // Answers the frames as the cadence says. The errors of a FrameDecoder, which
  // change nothing.
  absl::Status OnFrames(const v1::FrameBatch& batch);
  // Adds the final answer of the trial. The next frame begins another.
  void OnEndOfTrial();

  // Frames have come since the last end of a trial.
  bool trial_open() const { return trial_frames_ > 0; }
  uint64_t frames() const { return frames_; }
  // Frames that were lost before they came, over all trials.
  uint64_t frames_missing() const { return frames_missing_; }
  // Contacts that began, over all trials, and those that there are.
  uint64_t contacts_begun() const {
    return pipeline_ == nullptr ? 0 : pipeline_->contacts_begun();
  }
  int contacts_now() const;
  // Compares the capture times of the frames with the stated rate.
  const RateWatch& rate() const { return rate_; }
  // What was skipped so far.
  SkipCounters skipped() const;

 private:
  void OnFrame(const v1::FrameBatch& batch, uint32_t index,
               uint64_t missing_before);
  // Adds a notice, once per stream, if the capture times are those of another
  // rate. `missing` frames were lost before `batch`.
  void WatchRate(const v1::FrameBatch& batch, uint64_t missing);
  // Adds a notice, once per stream, if the contacts read unlike any of
  // training.
  void WatchSkin();
  // True if the cadence asks for an interim answer after this frame.
  bool IsDue();
  // True if the contacts, or what they probably are, differ from those of the
  // frame before.
  bool HasChanged();
  ContactPipeline& Pipeline();

  const StreamSettings settings_;
  const std::shared_ptr<const CompiledModel> model_;
  AnswerSink* const sink_;
  StreamTap* tap_ = nullptr;
  // Made for the first frame, because it is most of a stream's memory.
  std::unique_ptr<ContactPipeline> pipeline_;
  FrameDecoder decoder_;
  AnswerWriter writer_;
  RateWatch rate_;
  // Nothing if the model does not know what the taxels read in training.
  std::optional<SkinRangeWatch> skin_watch_;

  uint64_t frames_ = 0;
  uint64_t frames_missing_ = 0;
  // Frames of the open trial; 0 if none is open.
  uint64_t trial_frames_ = 0;
  // Contacts of the frame before by id, with their best classes; for
  // RESULT_CADENCE_ON_CHANGE.
  struct Seen {
    uint64_t id = 0;
    int best_class = 0;
    bool operator==(const Seen&) const = default;
  };
  std::array<Seen, limits::kMaxContacts> seen_ = {};
};

}  // namespace tactus::internal
