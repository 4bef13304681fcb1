#include "core/base/thread_priority.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <thread>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

struct Priority {
  int niceness = -1;
  // Time slice, ns; 0 where the kernel has none for time-sharing threads.
  uint64_t slice_ns = 0;
};

Priority Mine() {
  // The kernel's struct sched_attr; sched_runtime is its fourth number of eight
  // bytes.
  std::array<uint64_t, 6> attributes = {};
  EXPECT_EQ(
      syscall(SYS_sched_getattr, 0, attributes.data(), sizeof attributes, 0),
      0);
  return {getpriority(PRIO_PROCESS, 0), attributes[3]};
}

// In a thread, because a lowered priority cannot be raised again. Returns the
// priority of a thread that this one starts.
Priority InheritedAfter(ThreadPriority priority) {
  Priority inherited;
  std::thread([&] {
    EXPECT_TRUE(SetThreadPriority(priority));
    std::thread([&] { inherited = Mine(); }).join();
  }).join();
  return inherited;
}

TEST(ThreadPriorityTest, BackgroundThreadsHaveTheLowestNiceness) {
  const Priority before = Mine();
  const Priority inherited = InheritedAfter(ThreadPriority::kBackground);
  EXPECT_EQ(inherited.niceness, 19);
  if (before.slice_ns == 0) GTEST_SKIP() << "this kernel has fixed time slices";
  EXPECT_EQ(inherited.slice_ns, 20'000'000);
}

TEST(ThreadPriorityTest, PromptThreadsKeepTheirNicenessAndHaveShortSlices) {
  const Priority before = Mine();
  const Priority inherited = InheritedAfter(ThreadPriority::kPrompt);
  EXPECT_EQ(inherited.niceness, before.niceness);
  if (before.slice_ns == 0) GTEST_SKIP() << "this kernel has fixed time slices";
  EXPECT_EQ(inherited.slice_ns, 100'000);
}

TEST(ThreadPriorityTest, AttendantsGiveWayAndNeverRise) {
  const int before = Mine().niceness;
  EXPECT_EQ(InheritedAfter(ThreadPriority::kAttendant).niceness,
            std::max(before, 10));
  int lowered = -1;
  std::thread([&] {
    EXPECT_TRUE(SetThreadPriority(ThreadPriority::kBackground));
    EXPECT_TRUE(SetThreadPriority(ThreadPriority::kAttendant));
    lowered = Mine().niceness;
  }).join();
  EXPECT_EQ(lowered, 19);
}

}  // namespace
}  // namespace tactus::internal
