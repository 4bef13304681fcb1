// File: arrival_gate.h
//
// ArrivalGate: bounds the calls that gRPC holds for the server, from the moment
// when their headers are parsed until they are admitted or have ended.
// gRPC 1.51 has no such bound. A client that opens and resets calls in a row
// ("rapid reset") makes them faster than threads take them, about 11 kB each,
// and the limit on concurrent streams does not count a call that was reset.
//
//   if (!gate.TryEnter(MonotonicNs())) Refuse();
//
//   ArrivalGate::Request request(&gate);  // asks gRPC for the next call
//   request.Arrive();                     // a call has come
//   request.Admit();                      // another limit counts it now
//   // ~Request: the call has ended
//
// A call that gRPC drops before a thread takes it stays counted. Two rules
// correct that: at the limit one call per 10 ms enters nevertheless, and a call
// that comes for a request older than 100 ms shows that no call waited, so the
// count of waiting calls starts again at 0.
//
// Thread-safe, lock-free; a Request belongs to one thread.
#pragma once

#include <atomic>
#include <cstdint>

#include "server/ops/clock.h"

namespace tactus::internal::server {

class ArrivalGate {
 public:
  class Request {
   public:
    // `gate` must outlive it.
    explicit Request(ArrivalGate* gate) : gate_(gate) {}
    ~Request() { Admit(); }
    Request(const Request&) = delete;
    Request& operator=(const Request&) = delete;

    void Arrive() {
      arrived_ = true;
      gate_->Take(requested_ns_, MonotonicNs());
    }
    // From now on another limit counts the call.
    void Admit() {
      if (arrived_) --gate_->taken_;
      arrived_ = false;
    }

   private:
    ArrivalGate* const gate_;
    const int64_t requested_ns_ = MonotonicNs();
    bool arrived_ = false;
  };

  explicit ArrivalGate(int limit) : limit_(limit) {}

  // The headers of a call were parsed. False if it must be refused.
  bool TryEnter(int64_t now_ns) {
    if (waiting_ + taken_ >= limit_) {
      int64_t last = last_extra_ns_;
      if (now_ns - last < kExtraEveryNs ||
          !last_extra_ns_.compare_exchange_strong(last, now_ns)) {
        ++refused_;
        return false;
      }
    }
    ++waiting_;
    return true;
  }

  // A thread has taken a call, which it requested at `requested_ns`.
  void Take(int64_t requested_ns, int64_t now_ns) {
    ++taken_;
    if (now_ns - requested_ns > kQuietNs) {
      waiting_ = 0;
      return;
    }
    // Calls of the in-process channel are taken without having entered.
    int waiting = waiting_;
    while (waiting > 0 &&
           !waiting_.compare_exchange_weak(waiting, waiting - 1)) {
    }
  }

  // Calls that no thread has taken yet, and taken ones that have not ended.
  int waiting() const { return waiting_; }
  int taken() const { return taken_; }
  // Calls refused since the start.
  uint64_t refused() const { return refused_; }

 private:
  static constexpr int64_t kExtraEveryNs = 10'000'000;
  static constexpr int64_t kQuietNs = 100'000'000;

  const int limit_;
  std::atomic<int> waiting_ = 0;
  std::atomic<int> taken_ = 0;
  std::atomic<int64_t> last_extra_ns_ = 0;
  std::atomic<uint64_t> refused_ = 0;
};

}  // namespace tactus::internal::server
