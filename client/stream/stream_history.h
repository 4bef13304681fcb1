// File: stream_history.h
//
// StreamHistory: what a client must keep of its stream to go on after a lost
// connection as if nothing had happened. It decides which frames a new stream
// must get again, and makes the new stream's answers those of one stream.
//
//   StreamHistory history(config, started, limits::kMaxReplayBytes);
//   history.Add(batch);                     // before it is sent
//   if (const auto* response = history.Take(answer)) Use(*response);
//   // The connection is lost.
//   history.BeginStream();
//   while (history.NextUnsent(&batch)) Send(batch);
//
// What it keeps: the messages since the beginning of the trial. Messages before
// the last frame without a contact are dropped where no bit of an answer
// depends on them:
//
//   - The frame that a replay begins with is touched by no contact, and lies at
//     least 0.2 s before the next onset if frames have poses, because motion is
//     measured from the poses of this time (core/features/recent_poses.h).
//   - With RESULT_CADENCE_EVERY_N_FRAMES, N divides its place in the trial.
//   - On a skin with light touch, the background of each taxel is a mean over
//     the whole trial. Nothing is dropped.
//
// If that is more than fits, the oldest messages are dropped, and a replay is
// inexact (BeginStream): the server has never seen the beginning.
//
// Take changes what differs between two streams: ids of contacts,
// frames_missing and superseded count on; a final without contacts shows the
// last that ended, also if it is not sent again. All other fields are equal bit
// for bit, because the server computes them from equal frames. No answer is
// returned twice. With other cadences than every frame, `superseded` may also
// count some answers that the robot has had.
//
// No threads, no clock, no gRPC. After warm-up, nothing is allocated per frame
// until the first replay. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "absl/strings/string_view.h"
#include "client/stream/message_ring.h"
#include "core/skin/pose_spacing.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

// A contact that ended.
struct EndedContact {
  v1::Contact contact;
  int64_t onset_time_ns = 0;
  std::optional<v1::ContactScores> scores;
};

class StreamHistory {
 public:
  // How exact a replay is.
  enum class Beginning { kKnown, kLost };

  // `config` and `started` are those of the first stream. `max_bytes` is at
  // least limits::kMinReplayBytes.
  StreamHistory(const v1::StreamConfig& config,
                const v1::StreamStarted& started, size_t max_bytes);

  // Appends frames of the current trial. False if there is no room: then only
  // messages are left that were never sent.
  bool Add(const v1::FrameBatch& batch);
  // The trial will get no more frames; its final may be taken.
  void EndTrial() { ending_ = true; }

  // Reads the next message that the current stream has not got, and takes it
  // as sent. False if there is none.
  bool NextUnsent(v1::FrameBatch* batch);
  // Takes all messages as sent.
  void SentAll();

  // A new stream begins: all that is kept is unsent. kLost if frames that it
  // needs were dropped. The contacts in progress then go on with new ids,
  // without what was felt before.
  Beginning BeginStream();

  // Takes an answer of the current stream. Returns the response for the
  // robot, valid until the next call, or null if the robot has had it or must
  // not get it: a server that drains ends trials that the robot has not ended.
  const v1::ClassifyContactResponse* Take(
      const v1::ClassifyContactResponse& response);

  // Sequence number of the last frame added, of the last one in an answer
  // that was returned, and of the last one in an answer of this stream.
  uint64_t last_sequence() const { return last_sequence_; }
  uint64_t delivered() const { return delivered_; }
  uint64_t answered() const { return answered_; }
  bool has_unsent() const { return next_ != ring_.end(); }
  // EndTrial was called, and the final has not come.
  bool ending() const { return ending_; }
  // The trial has frames, so its final is still owed.
  bool trial_open() const { return trial_frames_ > 0; }
  // Frames that a second stream or a later one got again.
  uint64_t replayed_frames() const { return replayed_frames_; }
  size_t bytes() const { return ring_.bytes(); }
  size_t capacity() const { return ring_.capacity(); }

 private:
  // Stands before the bytes of a message.
  struct Head {
    uint64_t first_sequence = 0;
    uint64_t last_sequence = 0;
    // Frames of the trial before it, and frames missing until it.
    uint64_t frames_before = 0;
    uint64_t missing = 0;
    // A replay may begin with it, as far as poses and cadence are concerned.
    bool may_begin = false;
  };

  Head HeadAt(MessageRing::Position at) const;
  // Makes room by dropping messages that were sent once.
  char* Append(size_t bytes);
  void PopFront();
  // True if the robot may have this answer.
  bool IsNew(const v1::Answer& answer) const;
  const v1::ClassifyContactResponse* Rebase(
      const v1::ClassifyContactResponse& response);
  void CountContactsOn(v1::Answer* answer) const;
  void ShowEnded(v1::Answer* answer) const;
  // Learns from an answer that the robot gets.
  void Learn(const v1::Answer& answer);
  void LearnContacts(const v1::Answer& answer);
  // Drops the messages before the last one that a replay may begin with, given
  // that no contact touched the frames from idle_from_ to before `idle_to`.
  void DropBefore(uint64_t idle_to, uint64_t contacts);
  void FinishTrial();

  const bool every_frame_matters_;
  const uint64_t interval_;
  const bool with_poses_;
  PoseSpacing spacing_;
  // Frames before an onset that belong to it.
  const uint64_t lead_;
  const double period_ns_;

  MessageRing ring_;
  MessageRing::Position next_ = 0;
  uint64_t last_sequence_ = 0;
  int64_t last_time_ns_ = 0;
  // The largest sequence number that any stream got.
  uint64_t sent_ = 0;
  uint64_t replayed_frames_ = 0;
  // Frames of the current trial, and those missing from it.
  uint64_t trial_frames_ = 0;
  uint64_t missing_ = 0;
  bool ending_ = false;
  bool beginning_lost_ = false;

  uint64_t delivered_ = 0;
  uint64_t answered_ = 0;
  uint64_t superseded_ = 0;
  // As of the last answer: contacts so far, and whether there is one.
  uint64_t contacts_ = 0;
  bool is_touched_ = false;
  // Since it is touched: the first onset, and the contacts before it.
  uint64_t touched_from_ = 0;
  uint64_t contacts_until_touched_ = 0;
  // The frame after the one with which all contacts of this trial had ended,
  // and the contact that ended last.
  uint64_t idle_from_ = 0;
  std::optional<EndedContact> last_end_;
  uint64_t idle_to_ = 0;

  // The same before the first message in the ring.
  uint64_t contacts_before_ = 0;
  std::optional<EndedContact> end_before_;

  // The current stream is not the first, and what it does not know.
  bool is_resumed_ = false;
  uint64_t base_contacts_ = 0;
  uint64_t base_missing_ = 0;
  // Superseded answers of earlier streams, and those of this one that the
  // robot has had from an earlier stream.
  uint64_t base_superseded_ = 0;
  uint64_t repeated_superseded_ = 0;
  std::optional<EndedContact> base_end_;
  v1::ClassifyContactResponse rebased_;
};

}  // namespace tactus::internal::client
