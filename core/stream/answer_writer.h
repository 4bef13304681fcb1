// File: answer_writer.h
//
// AnswerWriter: writes the pipeline's contacts after a frame into an Answer,
// with the events of the frame. It keeps the sequence numbers and capture times
// of onsets and decisions, which the pipeline does not know.
//
//   pipeline.Step(frame);
//   writer.OnFrame(pipeline, frame, sequence, time_ns);
//   writer.Write(pipeline, false, answer);
//
// Allocates nothing once the answers have grown to their size. Not
// thread-safe: one per stream.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/limits.h"
#include "core/base/limits_questions.h"
#include "core/classify/contact_pipeline.h"
#include "core/skin/layout.h"
#include "core/stream/spare_messages.h"
#include "core/stream/stream_settings.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class AnswerWriter {
 public:
  // `settings` must outlive the writer.
  explicit AnswerWriter(const StreamSettings* settings);

  // Records the frame that `pipeline` took last.
  void OnFrame(const ContactPipeline& pipeline, const FrameView& frame,
               uint64_t sequence, int64_t capture_time_ns);
  // Resets what belongs to a trial.
  void OnEndOfTrial();

  // True if something happened at the frame: its answer must not be lost.
  bool has_events() const { return event_count_ > 0; }

  // Overwrites all fields of `answer` except superseded and the times of its
  // diagnostics. In a final, all contacts end.
  void Write(ContactPipeline& pipeline, bool is_final, v1::Answer* answer) {
    Write(pipeline, is_final, settings_->with_taxels, answer);
  }
  // The same with the taxels of contacts as `with_taxels` says.
  void Write(ContactPipeline& pipeline, bool is_final, bool with_taxels,
             v1::Answer* answer);

 private:
  // What a contact's answers need of its past.
  struct Past {
    uint64_t onset_sequence = 0;
    int64_t onset_time_ns = 0;
    // [questions]
    std::array<int64_t, limits::kMaxQuestions> decided_time_ns = {};
    std::array<int64_t, limits::kMaxQuestions> changed_time_ns = {};
    bool was_unknown = false;
    uint64_t merged_into = 0;
    // Where it began, or was at the last KIND_MOVED_OVER_SKIN.
    SkinPoint place;
  };

  void Begin(const ContactReport& report);
  void FindEvents(const ContactReport& report);
  void FindDecisions(const ContactReport& report);
  void FindTravel(const ContactReport& report);
  v1::ContactEvent& AddEvent(v1::ContactEvent::Kind kind, uint64_t contact_id);
  void WriteEvents(bool is_final, v1::Answer* answer);
  void WriteContact(ContactPipeline& pipeline, const ContactReport& report,
                    bool with_taxels, v1::Contact* contact);
  void WriteState(const ContactReport& report, v1::Contact* contact) const;
  void WritePatch(ContactPipeline& pipeline, const ContactReport& report,
                  bool with_taxels, v1::Contact* contact);
  void WritePlace(const SkinPoint& point, v1::SkinPlace* place) const;
  void WriteAnswers(const ContactReport& report, v1::Contact* contact);

  const StreamSettings* settings_;
  uint64_t sequence_ = 0;
  int64_t capture_time_ns_ = 0;
  uint64_t frames_missing_ = 0;
  bool has_pose_ = false;
  Pose pose_;
  // By the tracker's slots.
  std::array<Past, limits::kMaxContacts> past_;
  // The frame's events; grows to what one frame had at the most.
  std::vector<v1::ContactEvent> events_;
  size_t event_count_ = 0;
  SpareMessages<v1::Contact> spare_contacts_;
  SpareMessages<v1::ContactPatch> spare_patches_;
  SpareMessages<v1::ContactEvent> spare_events_;
  SpareMessages<v1::ContactScores> spare_scores_;
  SpareMessages<v1::Decision> spare_decisions_;
};

}  // namespace tactus::internal
