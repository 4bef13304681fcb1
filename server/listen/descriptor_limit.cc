#include "server/listen/descriptor_limit.h"

#include <sys/resource.h>

#include <algorithm>
#include <limits>

namespace tactus::internal::server {
namespace {

// An idle tactusd has 15 to 25 open.
constexpr int kOwnDescriptors = 64;

}  // namespace

int RaiseDescriptorLimit() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  if (limit.rlim_cur < limit.rlim_max) {
    const rlimit raised = {limit.rlim_max, limit.rlim_max};
    if (setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  }
  return static_cast<int>(
      std::min<rlim_t>(limit.rlim_cur, std::numeric_limits<int>::max()));
}

int ConnectionsThatFit(int descriptors) {
  return std::max(1, descriptors - kOwnDescriptors);
}

}  // namespace tactus::internal::server
