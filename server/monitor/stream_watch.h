// File: stream_watch.h
//
// StreamWatch: what one watcher has seen of one stream, and what is new to it.
//
//   StreamWatch watch(stream, {.frames_per_second = 10});
//   while (!watch.ended()) {
//     v1::StreamUpdate update;
//     if (watch.Update(now_ns, &update)) Send(update);
//   }
//
// Not thread-safe: one per watcher and stream. The stream shows its frames
// while there is a watch with frames.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "server/monitor/watched_stream.h"

namespace tactus::internal::server {

class StreamWatch {
 public:
  static constexpr std::chrono::milliseconds kLook{16};

  struct Options {
    // 0: none, only counts.
    uint32_t frames_per_second = limits::kMaxWatchedRateHz;
    bool with_taxels = true;
    // Events and frames from before the watch count as new.
    bool from_start = false;
  };

  StreamWatch(std::shared_ptr<WatchedStream> stream, const Options& options);
  ~StreamWatch();

  StreamWatch(const StreamWatch&) = delete;
  StreamWatch& operator=(const StreamWatch&) = delete;

  // Writes what is new; false, and nothing is written, if nothing is or if it
  // is too early for the next frame. Called every kLook or so, it asks for a
  // frame shortly before it is due.
  bool Update(int64_t now_ns, v1::StreamUpdate* update);
  // The last update said that the stream has ended.
  bool ended() const { return ended_; }
  const WatchedStream* stream() const { return stream_.get(); }

 private:
  bool ReadFrame(int64_t now_ns, bool ends, v1::StreamUpdate* update);

  const std::shared_ptr<WatchedStream> stream_;
  const Options options_;
  // Nanoseconds from one frame to the next.
  const int64_t period_ns_;
  WatchedStream::Cursor cursor_;
  bool described_ = false;
  bool ended_ = false;
  int64_t next_frame_ns_ = 0;
  int64_t counted_ns_ = 0;
};

}  // namespace tactus::internal::server
