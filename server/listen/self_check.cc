#include "server/listen/self_check.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/listen/listener_probe.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kLongestPeriod(2'000);

// One listening socket, and since when it has not answered.
struct Checked {
  std::string address;
  ListenerProbe probe;
  std::optional<Clock::time_point> failing_since;
};

}  // namespace

SelfCheck::SelfCheck(GrpcListener* listener, Options options)
    : listener_(listener), options_(std::move(options)) {
  thread_ = std::thread([this] { Run(); });
}

SelfCheck::~SelfCheck() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

bool SelfCheck::Sleep(milliseconds time) {
  std::unique_lock lock(mutex_);
  return !ended_.wait_for(lock, time, [this] { return end_; });
}

void SelfCheck::Run() {
  std::vector<Checked> all;
  Acceptor& acceptor = listener_->acceptor();
  for (const ListeningSocket& socket : acceptor.sockets()) {
    all.push_back(
        {socket.address,
         ListenerProbe(&acceptor, socket.bound, listener_->UsesTls(socket)),
         std::nullopt});
  }
  const milliseconds period = std::min(kLongestPeriod, options_.patience / 5);
  do {
    bool passed = true;
    for (Checked& checked : all) {
      const Clock::time_point start = Clock::now();
      const absl::Status status = checked.probe.Run(period);
      if (status.ok()) {
        checked.failing_since.reset();
        continue;
      }
      passed = false;
      if (!checked.failing_since) checked.failing_since = start;
      if (Clock::now() - *checked.failing_since >= options_.patience) {
        options_.on_failure(checked.address, status);
        return;
      }
    }
    if (passed) options_.on_pass();
  } while (Sleep(period));
}

}  // namespace tactus::internal::server
