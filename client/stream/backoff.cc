#include "client/stream/backoff.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal::client {

std::chrono::milliseconds Backoff::Next() {
  const std::chrono::milliseconds wait(std::llround(
      random_.Uniform(0.5, 1) * static_cast<double>(longest_.count())));
  longest_ = std::min(2 * longest_, kLongest);
  return wait;
}

}  // namespace tactus::internal::client
