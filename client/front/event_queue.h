// File: event_queue.h
//
// EventQueue: events of a stream that wait to be polled, the oldest first.
//
//   EventQueue events;
//   events.Add(event);
//   for (Event next; events.Poll(next);) Use(next);
//
// At most limits::kMaxPolledEvents wait; then the oldest gives way and is
// counted. Keeps its memory. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "tactus/answer.h"

namespace tactus::internal::client {

class EventQueue {
 public:
  void Add(const Event& event);
  // False if none waits; `event` is then as before.
  bool Poll(Event& event);
  uint64_t dropped();

 private:
  // Twice the room, with the oldest event first.
  void Grow();

  std::mutex mutex_;
  // A ring: `count_` events from `first_` on.
  std::vector<Event> ring_;
  size_t first_ = 0;
  size_t count_ = 0;
  uint64_t dropped_ = 0;
};

}  // namespace tactus::internal::client
