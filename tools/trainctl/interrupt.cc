#include "tools/trainctl/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <utility>

namespace tactus::internal::client {
namespace {

constexpr char kSignal = 's';
constexpr char kEnd = 'e';

// Where the handler writes.
std::atomic<int> g_pipe = -1;

void Handle(int) {
  const int before = errno;
  // A full pipe has the byte already.
  [[maybe_unused]] const auto written = write(g_pipe.load(), &kSignal, 1);
  errno = before;
}

}  // namespace

Interrupt::Interrupt(std::function<void()> action)
    : action_(std::move(action)) {
  if (pipe(pipe_) != 0) std::abort();
  g_pipe = pipe_[1];
  thread_ = std::thread([this] { Run(); });
  struct sigaction handler = {};
  handler.sa_handler = Handle;
  // The second signal ends the program.
  handler.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &handler, &before_);
}

Interrupt::~Interrupt() {
  sigaction(SIGINT, &before_, nullptr);
  [[maybe_unused]] const auto written = write(pipe_[1], &kEnd, 1);
  thread_.join();
  close(pipe_[0]);
  close(pipe_[1]);
}

void Interrupt::Run() {
  char byte = 0;
  while (read(pipe_[0], &byte, 1) < 0 && errno == EINTR) {
  }
  if (byte == kSignal) action_();
}

}  // namespace tactus::internal::client
