// File: signals.h
//
// StopSignals: SIGTERM, SIGINT and SIGHUP as something to wait for.
//
//   StopSignals signals;      // in main, before any thread starts
//   // ... start the server ...
//   signals.Wait();           // the first signal
//   // ... stop in good order; a second signal ends the process at once ...
//
// SIGHUP stops the server too: a terminal or a session that closes sends it,
// and there is nothing to reload. SIGPIPE is ignored, so that a write to a
// closed connection or to a log that nobody reads any more is only an error.
//
// Use from the main thread only.
#pragma once

#include <csignal>

namespace tactus::server {

class StopSignals {
 public:
  // Blocks the signals here and in all threads started from now on.
  StopSignals();

  // Returns the signal; from then on another one has its default effect.
  int Wait();

 private:
  sigset_t signals_;
};

}  // namespace tactus::server
