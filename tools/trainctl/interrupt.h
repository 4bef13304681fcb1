// File: interrupt.h
//
// Interrupt: runs an action when the user presses Ctrl-C, instead of ending the
// program, as long as it exists.
//
//   Interrupt interrupt([&] { watcher.Cancel(); });
//
// The action runs at most once, on a separate thread; a second Ctrl-C ends the
// program. One Interrupt may exist at a time.
#pragma once

#include <csignal>
#include <functional>
#include <thread>

namespace tactus::internal::client {

class Interrupt {
 public:
  explicit Interrupt(std::function<void()> action);
  ~Interrupt();

  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  void Run();

  const std::function<void()> action_;
  // A pipe: the signal's handler may do little more than write to one.
  int pipe_[2];
  struct sigaction before_;
  std::thread thread_;
};

}  // namespace tactus::internal::client
