#include "server/replicas/shared_locks.h"

#include <atomic>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/server/replicas/shared_catalog.h"
#include "tests/support/catalog_access.h"

namespace tactus::internal::server {
namespace {

using testing::Get;

class SharedLocksTest : public SharedCatalogTest {
 protected:
  absl::Status Check(const Lock& lock) const {
    return catalog_->Look(
        [&](const Transaction& look) { return lock.StillHeld(look); });
  }
};

TEST_F(SharedLocksTest, OneAtATimeAmongProcessesAndThreads) {
  const auto a = Join();
  const auto b = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*b, a->name()); }));
  SharedLocks of_a(catalog_.get(), a.get());
  SharedLocks of_b(catalog_.get(), b.get());
  auto lock = of_a.TryTake("operations/1");
  ASSERT_TRUE(lock.ok()) << lock.status();
  ASSERT_NE(*lock, nullptr);
  EXPECT_FALSE((*lock)->taken_over());
  EXPECT_TRUE(Check(**lock).ok());
  EXPECT_EQ(*of_a.TryTake("operations/1"), nullptr);
  EXPECT_EQ(*of_b.TryTake("operations/1"), nullptr);
  EXPECT_NE(*of_b.TryTake("operations/2"), nullptr);
  lock->reset();
  const auto again = of_b.TryTake("operations/1");
  ASSERT_NE(*again, nullptr);
  EXPECT_FALSE((*again)->taken_over());
}

TEST_F(SharedLocksTest, TakeWaits) {
  const auto a = Join();
  const auto b = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*b, a->name()); }));
  SharedLocks of_a(catalog_.get(), a.get());
  SharedLocks of_b(catalog_.get(), b.get());
  std::atomic<int> inside = 0;
  std::atomic<int> done = 0;
  std::vector<std::thread> threads;
  for (SharedLocks* const locks : {&of_a, &of_b, &of_a}) {
    threads.emplace_back([&, locks] {
      for (int i = 0; i < 5; ++i) {
        const auto lock = locks->Take("models");
        ASSERT_TRUE(lock.ok()) << lock.status();
        EXPECT_EQ(++inside, 1);
        --inside;
        ++done;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(done, 15);
}

// A process that was only slow finds that another one goes on, and what it
// wanted to change stays as it is.
TEST_F(SharedLocksTest, WhoWasTakenForDeadChangesNothing) {
  const auto a = Join();
  const auto b = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*b, a->name()); }));
  SharedLocks of_a(catalog_.get(), a.get());
  SharedLocks of_b(catalog_.get(), b.get());
  auto slow = of_a.TryTake("operations/1");
  ASSERT_NE(*slow, nullptr);
  a->Stop();
  std::unique_ptr<Lock> taken;
  ASSERT_TRUE(Eventually([&] {
    auto lock = of_b.TryTake("operations/1");
    taken = lock.ok() ? *std::move(lock) : nullptr;
    return taken != nullptr;
  }));
  EXPECT_TRUE(taken->taken_over());
  EXPECT_TRUE(Check(*taken).ok());
  const absl::Status lost = Check(**slow);
  EXPECT_TRUE(absl::IsAborted(lost)) << lost;
  EXPECT_FALSE(catalog_
                   ->Change([&](Transaction& change) -> absl::Status {
                     TACTUS_RETURN_IF_ERROR((*slow)->StillHeld(change));
                     return change.Put(Table::kTrials, "x", "of the slow one");
                   })
                   .ok());
  EXPECT_EQ(Get(*catalog_, "x"), std::nullopt);
  // Its end is not the end of the other one's.
  slow->reset();
  EXPECT_TRUE(Check(*taken).ok());
}

TEST_F(SharedLocksTest, ALockThatCouldNotBeReleasedIsReleasedLater) {
  const auto a = Join();
  const auto b = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*b, a->name()); }));
  SharedLocks of_a(catalog_.get(), a.get());
  SharedLocks of_b(catalog_.get(), b.get());
  auto lock = of_a.TryTake("models");
  ASSERT_NE(*lock, nullptr);
  server_->Stop();
  lock->reset();
  server_->Start();
  EXPECT_EQ(*of_b.TryTake("models"), nullptr);
  of_a.ReleaseAgain();
  EXPECT_NE(*of_b.TryTake("models"), nullptr);
}

}  // namespace
}  // namespace tactus::internal::server
