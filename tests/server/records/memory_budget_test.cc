#include "server/records/memory_budget.h"

#include <atomic>
#include <thread>
#include <vector>

#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(MemoryBudgetTest, TryTakeTakesWhatIsFree) {
  MemoryBudget budget(10);
  EXPECT_TRUE(budget.TryTake(7));
  EXPECT_FALSE(budget.TryTake(4));
  EXPECT_TRUE(budget.TryTake(3));
  budget.Return(7);
  EXPECT_TRUE(budget.TryTake(7));
}

// More than there is means all of it, alone.
TEST(MemoryBudgetTest, LeasesNeverExceedIt) {
  MemoryBudget budget(10);
  std::atomic<int> used = 0;
  std::atomic<int> most = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      const int bytes = t == 0 ? 1'000 : t;
      for (int i = 0; i < 200; ++i) {
        const MemoryBudget::Lease lease = budget.Take(bytes);
        const int now = used += std::min(bytes, 10);
        if (now > most) most = now;
        used -= std::min(bytes, 10);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(most, 10);
  EXPECT_TRUE(budget.TryTake(10)) << "all leases were returned";
}

}  // namespace
}  // namespace tactus::internal::server
