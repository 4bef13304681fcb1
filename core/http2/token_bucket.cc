#include "core/http2/token_bucket.h"

#include <algorithm>

namespace tactus::internal {

bool TokenBucket::Take(int64_t now_ns) {
  // The first token is taken from a full bucket.
  const double seconds =
      last_ns_ == 0 ? 0 : static_cast<double>(now_ns - last_ns_) * 1e-9;
  last_ns_ = now_ns;
  tokens_ = std::min(rate_.burst, tokens_ + seconds * rate_.per_second);
  if (tokens_ < 1) return false;
  tokens_ -= 1;
  return true;
}

}  // namespace tactus::internal
