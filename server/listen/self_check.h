// File: self_check.h
//
// SelfCheck: connects to each listening socket of this process every now and
// then, and reports a socket that has not answered for too long. A server that
// no longer accepts connections looks alive from outside; once it has ended,
// systemd or the container engine restarts it.
//
//   SelfCheck check(&listener, {.on_pass = PingWatchdog,
//                               .on_failure = LogAndExit});
//
// Runs one thread, on which both functions are called. `listener` must outlive
// it and must not be stopped before it ends.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "server/listen/grpc_listener.h"

namespace tactus::internal::server {

class SelfCheck {
 public:
  struct Options {
    // How long a socket may fail to answer.
    std::chrono::milliseconds patience{10'000};
    // After each round in which all sockets answered.
    std::function<void()> on_pass;
    // Once a socket has not answered for `patience`: its address and the last
    // error. Called once; the check then ends.
    std::function<void(const std::string& address, const absl::Status& error)>
        on_failure;
  };

  SelfCheck(GrpcListener* listener, Options options);
  // Ends the check; waits for a probe that is under way.
  ~SelfCheck();

  SelfCheck(const SelfCheck&) = delete;
  SelfCheck& operator=(const SelfCheck&) = delete;

 private:
  void Run();
  // False once the check is to end.
  bool Sleep(std::chrono::milliseconds time);

  GrpcListener* const listener_;
  const Options options_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace tactus::internal::server
