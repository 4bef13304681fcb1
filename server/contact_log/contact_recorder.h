// File: contact_recorder.h
//
// ContactRecorder: records one stream from before each contact to its end. It
// keeps the robot's messages as they came, and the answers with events, in
// chunks of a pool. What it finished goes to a RecordingSink.
//
//   ContactRecorder recorder(&pool, &sink, stream);
//   session.SetTap(&recorder);
//   session.OnFrames(batch);
//   recorder.EndMessage(&batch, now_ms);   // after each message that was taken
//   recorder.EndStream(now_ms);
//
// A recording begins up to kBeforeContactChunks chunks before a contact, and
// ends when no contact is left. Nothing here allocates, locks or waits: a
// stretch that finds no free chunk is left out and counted.
//
// Used on the stream's thread alone; all pointers must outlive it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/skin/pose_spacing.h"
#include "core/stream/stream_tap.h"
#include "server/contact_log/chunk_pool.h"
#include "server/contact_log/finished_recording.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::server {

class RecordingSink {
 public:
  // Takes a recording, or leaves it as it is and returns false if it would have
  // to wait.
  virtual bool TryTake(FinishedRecording& recording) = 0;
  // Takes a recording at the end of its stream, when it may wait for a moment.
  virtual void Take(FinishedRecording& recording) = 0;
  // A stretch could not be recorded, because memory was full or the disk slow.
  virtual void OnLeftOut() = 0;

 protected:
  ~RecordingSink() = default;
};

class ContactRecorder final : public StreamTap {
 public:
  ContactRecorder(ChunkPool* pool, RecordingSink* sink,
                  std::shared_ptr<const v1::RecordedStream> stream);
  // What is not finished is lost.
  ~ContactRecorder() override;

  ContactRecorder(const ContactRecorder&) = delete;
  ContactRecorder& operator=(const ContactRecorder&) = delete;

  v1::Answer* Want(bool has_events) override {
    return has_events ? &answer_ : nullptr;
  }
  void Take(const FrameView& frame, const v1::Answer& answer) override;
  // After a message that the session has taken; null if it had no frames.
  // `now_ms`: milliseconds since 1970 (UTC).
  void EndMessage(const v1::FrameBatch* frames, int64_t now_ms);
  // The stream is over, and so is the session's last trial.
  void EndStream(int64_t now_ms);

 private:
  // Appends a field of a v1::Recording.
  bool Append(int field, const google::protobuf::MessageLite& message,
              int most_chunks);
  // Keeps frames before a contact, in place of the oldest if need be.
  // `is_start`: a recording may begin with them (StepPoses).
  void KeepBefore(const v1::FrameBatch& frames, bool is_start);
  void DropOldestBefore();
  // Takes the poses of a message. True if the estimates that a replay makes
  // of them are those of the stream if it begins here: always without poses.
  bool StepPoses(const v1::FrameBatch& frames);
  // True if answers from here on do not depend on what is not kept.
  bool IsSettled() const;
  // Gives the stretch up, and its memory back.
  void Lose();
  void Finish(int64_t now_ms);
  // Begins anew, at the start of a trial or within one.
  void Begin(bool at_trial_start);

  ChunkPool* const pool_;
  RecordingSink* const sink_;
  const bool light_touch_;
  const bool with_poses_;
  // Frames before a contact from which on its answers do not depend on earlier
  // ones: poses count for 0.2 s, and a contact lasts for 0.5 s longer than its
  // touch.
  const uint64_t settled_frames_;
  v1::Answer answer_;

  FinishedRecording current_;
  // A finished one that the sink had no time for.
  FinishedRecording waiting_;
  bool from_trial_start_ = true;
  // Frames before a contact in a chunk.
  struct Before {
    uint64_t frames = 0;
    // The first message that a recording may begin with: bytes and frames of
    // the chunk before it.
    bool has_start = false;
    uint32_t start_bytes = 0;
    uint64_t start_frames = 0;
  };
  std::array<Before, limits::kBeforeContactChunks> before_ = {};
  // Those of the stream, and the sequence number that follows, 0 at the start
  // of a trial.
  PoseSpacing spacing_;
  uint64_t next_sequence_ = 0;
  // A contact has begun since; how many there are now.
  bool recording_ = false;
  int open_ = 0;
  // Something found no room: the stretch is worth nothing.
  bool lost_ = false;
  bool trial_ended_ = false;
};

}  // namespace tactus::internal::server
