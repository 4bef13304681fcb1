#include "server/trainer/yield_timer.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "core/base/run_on_threads.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

// Computes until the calling thread has yielded `more` times. Goes on for ever
// if it does not; ctest ends it.
void ComputeForYields(uint64_t more) {
  const uint64_t enough = YieldsOfThisThread() + more;
  // The thread sanitizer handles signals in calls that it intercepts only.
  std::mutex intercepted;
  while (YieldsOfThisThread() < enough) {
    const std::lock_guard lock(intercepted);
  }
}

TEST(YieldTimerTest, AThreadThatComputesYieldsAgainAndAgain) {
  std::thread([] {
    YieldAtIntervals();
    ComputeForYields(5);
  }).join();
}

TEST(YieldTimerTest, EachThreadOfAParallelForYields) {
  std::atomic<int> running = 0;
  std::array<uint64_t, 2> yields = {};
  Yielding(OnThreads(2))(2, [&](int i) {
    // Both threads have a body.
    ++running;
    while (running < 2) std::this_thread::yield();
    ComputeForYields(3);
    yields[i] = YieldsOfThisThread();
  });
  EXPECT_GE(yields[0], 3u);
  EXPECT_GE(yields[1], 3u);
}

TEST(YieldTimerTest, OtherThreadsAreLeftAlone) {
  uint64_t yields = 1;
  std::thread([&] {
    std::thread([] {
      YieldAtIntervals();
      ComputeForYields(3);
    }).join();
    yields = YieldsOfThisThread();
  }).join();
  EXPECT_EQ(yields, 0u);
}

TEST(YieldTimerTest, ReadsOfAPipeGoOn) {
  std::array<int, 2> ends;
  ASSERT_EQ(pipe(ends.data()), 0);
  ssize_t got = 0;
  uint64_t yields = 0;
  std::thread reader([&] {
    YieldAtIntervals();
    char byte = 0;
    got = read(ends[0], &byte, 1);
    yields = YieldsOfThisThread();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_EQ(write(ends[1], "x", 1), 1);
  reader.join();
  EXPECT_EQ(got, 1);
  EXPECT_GE(yields, 1u);
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace tactus::internal::server
