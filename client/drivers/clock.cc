#include "client/drivers/clock.h"

#include <chrono>
#include <thread>

namespace tactus::internal::client {
namespace {

class SystemClock : public Clock {
 public:
  int64_t NowNs() override {
    return std::chrono::nanoseconds(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  void SleepNs(int64_t duration_ns) override {
    std::this_thread::sleep_for(std::chrono::nanoseconds(duration_ns));
  }
};

}  // namespace

Clock& Clock::System() {
  static auto* const clock = new SystemClock();
  return *clock;
}

}  // namespace tactus::internal::client
