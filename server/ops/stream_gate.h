// File: stream_gate.h
//
// StreamGate: counts the open calls of one kind and decides whether another
// may open, for all peers together and for each peer.
//
//   StreamGate gate("streams", {.all = 2000, .per_peer = 1000});
//   TACTUS_RETURN_IF_ERROR(gate.Enter(peer));
//   // ... serve the stream ...
//   gate.Leave(peer, frames);
//
// Thread-safe. Enter and Leave take a lock; they run once per call, not once
// per frame.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "absl/status/status.h"
#include "core/base/errors.h"

namespace tactus::internal::server {

class StreamGate {
 public:
  struct Limits {
    int all = 0;
    // 0 means none.
    int per_peer = 0;
  };

  // `what` names the calls in errors, e.g. "streams".
  StreamGate(std::string what, const Limits& limits)
      : what_(std::move(what)), limits_(limits) {}

  // STREAM_LIMIT if the server or `peer` has as many calls as it may have.
  absl::Status Enter(const std::string& peer) {
    const std::lock_guard lock(mutex_);
    if (live_ >= limits_.all) {
      ++refused_;
      return StreamLimit(what_, limits_.all);
    }
    int& of_peer = live_of_[peer];
    if (limits_.per_peer > 0 && of_peer >= limits_.per_peer) {
      ++refused_;
      return PeerStreamLimit(what_, peer, limits_.per_peer);
    }
    ++of_peer;
    ++live_;
    ++opened_;
    return absl::OkStatus();
  }
  // Once for each successful Enter, with the same peer.
  void Leave(const std::string& peer, uint64_t frames) {
    const std::lock_guard lock(mutex_);
    const auto found = live_of_.find(peer);
    if (--found->second == 0) live_of_.erase(found);
    frames_ += frames;
    ++closed_;
    --live_;
  }

  // Open calls.
  int live() const { return live_; }
  // Totals since the start: calls admitted, ended and refused; frames of those
  // that ended.
  uint64_t opened() const { return opened_; }
  uint64_t closed() const { return closed_; }
  uint64_t refused() const { return refused_; }
  uint64_t frames() const { return frames_; }

 private:
  const std::string what_;
  const Limits limits_;
  std::mutex mutex_;
  std::unordered_map<std::string, int> live_of_;
  // Written under the lock, read without it.
  std::atomic<int> live_ = 0;
  std::atomic<uint64_t> opened_ = 0;
  std::atomic<uint64_t> closed_ = 0;
  std::atomic<uint64_t> refused_ = 0;
  std::atomic<uint64_t> frames_ = 0;
};

}  // namespace tactus::internal::server
