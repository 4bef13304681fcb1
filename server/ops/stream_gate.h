// File: stream_gate.h
//
// StreamGate: how many streams there are, and whether another may come.
//
//   if (!gate.TryEnter()) return StreamLimit(gate.limit());
//   // ... serve the stream ...
//   gate.Leave(frames);
//
// Thread-safe, lock-free.
#pragma once

#include <atomic>
#include <cstdint>

namespace tactus::server {

class StreamGate {
 public:
  explicit StreamGate(int limit) : limit_(limit) {}

  bool TryEnter() {
    int live = live_.load();
    while (live < limit_) {
      if (live_.compare_exchange_weak(live, live + 1)) {
        opened_.fetch_add(1);
        return true;
      }
    }
    refused_.fetch_add(1);
    return false;
  }
  // Once for each successful TryEnter.
  void Leave(uint64_t frames) {
    frames_.fetch_add(frames);
    closed_.fetch_add(1);
    live_.fetch_sub(1);
  }

  int limit() const { return limit_; }
  int live() const { return live_.load(); }
  // Since the start: streams admitted, ended, turned away; frames of those
  // ended.
  uint64_t opened() const { return opened_.load(); }
  uint64_t closed() const { return closed_.load(); }
  uint64_t refused() const { return refused_.load(); }
  uint64_t frames() const { return frames_.load(); }

 private:
  const int limit_;
  std::atomic<int> live_ = 0;
  std::atomic<uint64_t> opened_ = 0;
  std::atomic<uint64_t> closed_ = 0;
  std::atomic<uint64_t> refused_ = 0;
  std::atomic<uint64_t> frames_ = 0;
};

}  // namespace tactus::server
