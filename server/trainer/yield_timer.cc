#include "server/trainer/yield_timer.h"

#include <sched.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <mutex>
#include <utility>

namespace tactus::internal::server {
namespace {

constexpr long kIntervalNs = 500'000;
constexpr int kSignal = SIGURG;

// Written by the handler, which interrupts its own thread only.
thread_local volatile uint64_t yields = 0;

void Yield(int) {
  const int error = errno;
  sched_yield();
  yields = yields + 1;
  errno = error;
}

// A timer that sends the calling thread a signal at each interval.
class YieldTimer {
 public:
  YieldTimer() {
    static std::once_flag installed;
    std::call_once(installed, [] {
      struct sigaction action = {};
      action.sa_handler = Yield;
      action.sa_flags = SA_RESTART;
      sigaction(kSignal, &action, nullptr);
    });
    sigevent event = {};
    event.sigev_notify = SIGEV_THREAD_ID;
    event.sigev_signo = kSignal;
    // glibc 2.36 has no name for it.
    event._sigev_un._tid = static_cast<pid_t>(syscall(SYS_gettid));
    created_ = timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
    if (!created_) return;
    const itimerspec interval = {{0, kIntervalNs}, {0, kIntervalNs}};
    timer_settime(timer_, 0, &interval, nullptr);
  }
  YieldTimer(const YieldTimer&) = delete;
  YieldTimer& operator=(const YieldTimer&) = delete;
  ~YieldTimer() {
    if (created_) timer_delete(timer_);
  }

 private:
  timer_t timer_ = {};
  bool created_ = false;
};

}  // namespace

void YieldAtIntervals() { thread_local const YieldTimer timer; }

ParallelFor Yielding(ParallelFor parallel) {
  return [parallel = std::move(parallel)](
             int count, const std::function<void(int)>& body) {
    parallel(count, [&](int i) {
      YieldAtIntervals();
      body(i);
    });
  };
}

uint64_t YieldsOfThisThread() { return yields; }

}  // namespace tactus::internal::server
