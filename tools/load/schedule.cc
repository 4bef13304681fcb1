#include "tools/load/schedule.h"

#include <algorithm>

#include "core/base/random.h"

namespace tactus::internal::client {

Schedule::Schedule(int robots, int64_t start_ns, int64_t period_ns,
                   uint64_t seed)
    : start_ns_(start_ns), period_ns_(period_ns) {
  Random random(seed);
  for (int i = 0; i < robots; ++i) {
    phases_ns_.push_back(
        static_cast<int64_t>(random.Index(static_cast<size_t>(period_ns))));
  }
  std::sort(phases_ns_.begin(), phases_ns_.end());
}

}  // namespace tactus::internal::client
