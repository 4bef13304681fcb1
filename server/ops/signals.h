// File: signals.h
//
// StopSignals: SIGTERM, SIGINT and SIGHUP as something to wait for.
//
//   StopSignals signals;      // in main, before any thread starts
//   // ... start the server ...
//   signals.Wait();           // the first signal
//   // ... stop in good order; a second signal ends the process at once ...
//
//   signals.Wait([&] { Reload(); });  // SIGHUP reloads instead
//
// If there is nothing to reload, SIGHUP stops the server too: a terminal or a
// session that closes sends it. SIGPIPE is ignored, so that a write to a
// closed connection or to a log that nobody reads any more is only an error.
//
// Use from the main thread only.
#pragma once

#include <csignal>
#include <functional>

namespace tactus::internal::server {

class StopSignals {
 public:
  // Blocks the signals here and in all threads started from now on.
  StopSignals();

  // Returns the signal that stops; from then on another one has its default
  // effect. `on_hangup`, if given, is called on each SIGHUP, which then does
  // not stop and has no effect after the return.
  int Wait(const std::function<void()>& on_hangup = nullptr);

 private:
  sigset_t signals_;
};

}  // namespace tactus::internal::server
