#include "server/ops/signals.h"

#include <pthread.h>

namespace tactus::internal::server {

StopSignals::StopSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

int StopSignals::Wait(const std::function<void()>& on_hangup) {
  int signal = 0;
  while (true) {
    if (sigwait(&signals_, &signal) != 0) continue;
    if (signal != SIGHUP || !on_hangup) break;
    on_hangup();
  }
  if (on_hangup) sigdelset(&signals_, SIGHUP);
  pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
  return signal;
}

}  // namespace tactus::internal::server
