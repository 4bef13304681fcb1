// File: memory_bus.h
//
// MemoryBus: a CAN bus in memory between a driver and a simulated skin, on a
// clock that moves only when the driver waits. Runs are repeatable and take no
// time. Test-only.
//
//   ManualClock clock;
//   MemoryBus bus(&boards, &clock);
//   bus.copies = [](const CanFrame&) { return 2; };  // repeats every frame
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "client/drivers/can/can_bus.h"
#include "client/drivers/clock.h"
#include "core/base/errors.h"
#include "tools/fakeskin/can_peer.h"

namespace tactus::internal::client {

class ManualClock : public Clock {
 public:
  int64_t NowNs() override { return now_ns_; }
  void SleepNs(int64_t duration_ns) override { now_ns_ += duration_ns; }

 private:
  int64_t now_ns_ = 1'000'000'000;
};

class MemoryBus : public CanBus {
 public:
  MemoryBus(CanPeer* peer, ManualClock* clock) : peer_(peer), clock_(clock) {}

  // How often a frame of the skin arrives; unset: once.
  std::function<int(const CanFrame&)> copies;
  // Frames that arrive before any of the skin.
  std::vector<CanFrame> garbage;
  // Set: the adapter is gone, and every call fails with this text.
  std::string gone;
  // Set: the next Receive fails with this text; Open repairs it.
  std::string broken;
  int opens = 0;
  std::vector<CanFrame> sent;

  std::string name() const override { return "memory"; }
  absl::Status Open(std::span<const CanFilter> filters) override {
    if (!gone.empty()) return IoError(name(), gone);
    filters_.assign(filters.begin(), filters.end());
    broken.clear();
    open_ = true;
    ++opens;
    return absl::OkStatus();
  }
  void Close() override {
    open_ = false;
    waiting_.clear();
  }
  absl::Status Send(const CanFrame& frame) override {
    if (!gone.empty() || !open_) return IoError(name(), "send: " + gone);
    sent.push_back(frame);
    peer_->OnFrame(frame, clock_->NowNs());
    return absl::OkStatus();
  }
  absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns) override {
    const int64_t deadline_ns = clock_->NowNs() + timeout_ns;
    while (true) {
      if (!gone.empty()) return IoError(name(), gone);
      if (!broken.empty()) return IoError(name(), broken);
      if (!open_) return IoError(name(), "is closed");
      if (!garbage.empty()) {
        waiting_.insert(waiting_.end(), garbage.begin(), garbage.end());
        garbage.clear();
      }
      if (!waiting_.empty()) {
        frame = waiting_.front();
        waiting_.erase(waiting_.begin());
        ++counters_.received;
        return true;
      }
      CanFrame next;
      if (peer_->Emit(clock_->NowNs(), next)) {
        if (!PassesAny(filters_, next)) continue;
        const int count = copies ? copies(next) : 1;
        for (int i = 0; i < count; ++i) waiting_.push_back(next);
        continue;
      }
      const int64_t next_ns = std::min(peer_->NextNs(), deadline_ns);
      if (next_ns >= deadline_ns) {
        clock_->SleepNs(deadline_ns - clock_->NowNs());
        return false;
      }
      clock_->SleepNs(next_ns - clock_->NowNs());
    }
  }
  CanCounters counters() const override { return counters_; }

 private:
  CanPeer* const peer_;
  ManualClock* const clock_;
  bool open_ = false;
  std::vector<CanFilter> filters_;
  std::vector<CanFrame> waiting_;
  CanCounters counters_;
};

}  // namespace tactus::internal::client
