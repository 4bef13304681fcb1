#include "core/base/thread_priority.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace tactus::internal {
namespace {

constexpr uint64_t kPromptSliceNs = 100'000;
constexpr uint64_t kBackgroundSliceNs = 20'000'000;
constexpr int kLowest = 19;
constexpr int kAttending = 10;

// struct sched_attr of sched_setattr(2), first version. glibc 2.36 has neither
// it nor the call, and the kernel's header does not go with glibc's.
struct SchedulingAttributes {
  uint32_t size = sizeof(SchedulingAttributes);
  uint32_t policy = SCHED_OTHER;
  uint64_t flags = 0;
  int32_t niceness = 0;
  uint32_t real_time_priority = 0;
  // The time slice of a thread that shares processors.
  uint64_t runtime_ns = 0;
  uint64_t deadline_ns = 0;
  uint64_t period_ns = 0;
};
static_assert(sizeof(SchedulingAttributes) == 48);

bool SetTimeSharing(int niceness, uint64_t slice_ns) {
  const SchedulingAttributes attributes = {.niceness = niceness,
                                           .runtime_ns = slice_ns};
  return syscall(SYS_sched_setattr, 0, &attributes, 0) == 0;
}

}  // namespace

bool SetThreadPriority(ThreadPriority priority) {
  if (priority == ThreadPriority::kBackground) {
    return SetTimeSharing(kLowest, kBackgroundSliceNs);
  }
  if (sched_getscheduler(0) != SCHED_OTHER) return true;
  const int niceness = getpriority(PRIO_PROCESS, 0);
  if (priority == ThreadPriority::kAttendant) {
    return setpriority(PRIO_PROCESS, 0, std::max(niceness, kAttending)) == 0;
  }
  return SetTimeSharing(niceness, kPromptSliceNs);
}

}  // namespace tactus::internal
