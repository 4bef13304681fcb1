// File: signals.h
//
// StopSignals: SIGTERM and SIGINT as something to wait for.
//
//   StopSignals signals;      // in main, before any thread starts
//   // ... start the server ...
//   signals.Wait();           // the first signal
//   // ... stop in good order; a second signal ends the process at once ...
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
