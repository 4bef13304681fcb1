// File: watched_stream.h
//
// WatchedStream: one open stream, as others than its robot see it. The stream's
// thread puts in what happens; watchers on other threads take out what is new.
//
//   WatchedStream stream(description);
//   session.SetTap(&stream);                   // the stream's thread
//   stream.BeginMessage(now_ns);
//   stream.EndMessage({.frames = 1}, now_ns);
//
//   stream.AddWatcher();                       // any thread
//   WatchedStream::Cursor cursor;
//   stream.Ask();
//   stream.ReadNew(now_ns, true, &cursor, &update);
//   stream.RemoveWatcher();
//
// While nobody watches, a frame costs one relaxed load. While somebody does,
// the stream shows a frame after each Ask, and those with events, so that a
// watcher costs as much as it looks. The stream's thread never waits: if a
// watcher holds the lock, the next frame is shown instead.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/limits_monitor.h"
#include "core/stream/stream_tap.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::server {

class WatchedStream final : public StreamTap {
 public:
  // What a stream has had so far.
  struct Counts {
    uint64_t frames = 0;
    uint64_t frames_missing = 0;
    uint64_t superseded = 0;
    uint64_t contacts = 0;
    int contacts_now = 0;
  };
  // What a watcher has seen.
  struct Cursor {
    uint64_t frames = 0;
    uint64_t events = 0;
  };

  // `description` without counts. `expected`: somebody who watches all streams
  // has not found it yet; until then it counts as watched.
  explicit WatchedStream(v1::OpenStream description, bool expected = false);

  // For the stream's thread: around each message of the robot.
  void BeginMessage(int64_t now_ns) { message_ns_ = now_ns; }
  void EndMessage(const Counts& counts, int64_t now_ns);
  v1::Answer* Want(bool has_events) override;
  void Take(const FrameView& frame, const v1::Answer& answer) override;
  // The stream is over. Watchers may still read what it had.
  void End();

  // For any thread.
  bool ended() const { return ended_; }
  const std::string& id() const { return description_.stream_id(); }
  // The id as a number; streams that opened later have larger ones.
  uint64_t number() const { return number_; }
  // The description with counts.
  v1::OpenStream Describe(int64_t now_ns) const;
  void WriteCounts(int64_t now_ns, v1::StreamCounts* counts) const;
  void AddWatcher() { ++watchers_; }
  void RemoveWatcher() { --watchers_; }
  // Whoever watches all streams has found it, and has called AddWatcher if
  // frames are wanted.
  void Found();
  // Asks for the next frame to be shown.
  void Ask() { asked_.store(true, std::memory_order_relaxed); }
  // Writes the newest frame and the events that `cursor` has not seen, and
  // moves it on. False, and nothing is written, if there are none.
  bool ReadNew(int64_t now_ns, bool with_taxels, Cursor* cursor,
               v1::StreamUpdate* update);
  // A cursor of a watcher that comes now: it sees frames and events from now
  // on. What was shown last may be old, because nobody may have asked since.
  Cursor Now();

 private:
  // Moves what waits to where watchers see it.
  void ShowEvents();

  const v1::OpenStream description_;
  const uint64_t number_;

  // Used on the stream's thread alone.
  int64_t message_ns_ = 0;
  v1::Answer answer_;
  // Frames and time at the start of the window that a rate is measured in.
  uint64_t window_frames_ = 0;
  int64_t window_ns_ = 0;

  // Written by the stream's thread alone.
  std::atomic<uint64_t> frames_ = 0;
  std::atomic<uint64_t> frames_missing_ = 0;
  std::atomic<uint64_t> superseded_ = 0;
  std::atomic<uint64_t> contacts_ = 0;
  std::atomic<int> contacts_now_ = 0;
  std::atomic<double> measured_rate_hz_ = 0;
  std::atomic<int64_t> last_message_ns_ = 0;

  std::atomic<int> watchers_;
  std::atomic<bool> expected_;
  std::atomic<bool> asked_ = false;
  std::atomic<bool> ended_ = false;

  // Events that watchers may not have seen; the stream's thread adds to
  // `waiting_` what it could not put into `events_`.
  std::vector<v1::WatchedEvent> waiting_;
  std::mutex mutex_;
  // The newest of all; empty before the first watcher.
  std::vector<v1::WatchedEvent> events_;
  uint64_t event_count_ = 0;
  // The newest frame that watchers may see.
  v1::Answer shown_;
  std::vector<float> taxels_;
  int64_t taken_ns_ = 0;
  uint64_t shown_count_ = 0;
};

}  // namespace tactus::internal::server
