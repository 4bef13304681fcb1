#include "server/replicas/replica.h"

#include <atomic>

#include "gmock/gmock.h"
#include "tests/server/replicas/shared_catalog.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ReplicaTest : public SharedCatalogTest {};

TEST_F(ReplicaTest, EachProcessHasItsOwnName) {
  const auto a = Join();
  const auto b = Join();
  EXPECT_EQ(a->name(), "replicas/1");
  EXPECT_EQ(b->name(), "replicas/2");
  const auto all = a->All();
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->size(), 2u);
  EXPECT_TRUE((*all)[0].is_this);
  EXPECT_FALSE((*all)[1].is_this);
  EXPECT_TRUE(Eventually([&] { return IsAlive(*a, b->name()); }));
  EXPECT_FALSE(IsAlive(*a, "replicas/9"));
}

TEST_F(ReplicaTest, AProcessThatIsSilentIsDeadAndOneThatSpeaksIsNot) {
  const auto a = Join();
  const auto b = Join();
  const auto c = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*a, b->name()); }));
  b->Stop();
  EXPECT_TRUE(Eventually([&] { return !IsAlive(*a, b->name()); }));
  EXPECT_TRUE(IsAlive(*a, c->name()));
  EXPECT_TRUE(IsAlive(*c, a->name()));
}

TEST_F(ReplicaTest, AProcessThatEndsIsGoneAtOnce) {
  const auto a = Join();
  auto b = Join();
  const std::string name = b->name();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*a, name); }));
  b.reset();
  EXPECT_TRUE(Eventually([&] { return a->All()->size() == 1; }));
  EXPECT_TRUE(Eventually([&] { return !IsAlive(*a, name); }));
}

// Whoever is gone may leave a job: its looks at all jobs are worth it then, and
// only then.
TEST_F(ReplicaTest, IsToldOnceOfEachThatIsGone) {
  std::atomic<int> beats = 0;
  std::atomic<int> gone = 0;
  v1::StoredReplica about;
  about.set_address("here:1");
  auto a = Replica::Register(catalog_.get(), about, kQuickPace);
  ASSERT_TRUE(a.ok()) << a.status();
  const auto silent = Join();
  auto ended = Join();
  (*a)->Start([&](bool one_is_gone) {
    ++beats;
    if (one_is_gone) ++gone;
  });
  const auto ten_beats_pass = [&] {
    const int before = beats;
    return Eventually([&] { return beats >= before + 10; });
  };
  ASSERT_TRUE(ten_beats_pass());
  EXPECT_EQ(gone, 0);
  ended.reset();
  EXPECT_TRUE(Eventually([&] { return gone == 1; }));
  silent->Stop();
  EXPECT_TRUE(Eventually([&] { return gone == 2; }));
  EXPECT_TRUE((*a)->IsDead(silent->name()));
  // It stays dead, and one that is dead ends as nothing new.
  ASSERT_TRUE(ten_beats_pass());
  EXPECT_EQ(gone, 2);
  ASSERT_TRUE(catalog_
                  ->Change([&](Transaction& change) {
                    return change.Erase(Table::kBeats, silent->name());
                  })
                  .ok());
  ASSERT_TRUE(ten_beats_pass());
  EXPECT_EQ(gone, 2);
  (*a)->Stop();
}

// Nobody could speak while the database was away, longer than the dead are
// silent.
TEST_F(ReplicaTest, ATimeWithoutTheDatabaseKillsNobody) {
  const auto a = Join();
  const auto b = Join();
  ASSERT_TRUE(Eventually([&] { return IsAlive(*a, b->name()); }));
  server_->Stop();
  for (int i = 0; i < 250; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(a->IsDead(b->name()));
  }
  server_->Start();
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(a->IsDead(b->name()));
    EXPECT_FALSE(b->IsDead(a->name()));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

TEST_F(ReplicaTest, WaitsForThoseThatLiveAndServe) {
  const auto a = Join();
  const auto b = Join();
  // A worker has no streams, and is not waited for.
  const auto worker = Join("");
  ASSERT_TRUE(Eventually(
      [&] { return IsAlive(*a, b->name()) && IsAlive(*a, worker->name()); }));
  ASSERT_TRUE(a->SayServed(7).ok());
  auto lagging = a->WaitServed(7, std::chrono::milliseconds(100));
  ASSERT_TRUE(lagging.ok()) << lagging.status();
  EXPECT_THAT(*lagging, ElementsAre(b->name()));
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(b->SayServed(7).ok());
  });
  lagging = a->WaitServed(7, std::chrono::seconds(20));
  later.join();
  EXPECT_THAT(*lagging, IsEmpty());
  // The dead are not waited for.
  b->Stop();
  ASSERT_TRUE(Eventually([&] { return !IsAlive(*a, b->name()); }));
  ASSERT_TRUE(a->SayServed(8).ok());
  EXPECT_THAT(*a->WaitServed(8, std::chrono::seconds(20)), IsEmpty());
}

}  // namespace
}  // namespace tactus::internal::server
