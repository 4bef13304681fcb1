// What a catalogue in PostgreSQL does when the database fails.
#include "core/postgres/postgres_catalog.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/postgres/pg_connection.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/catalog_access.h"
#include "tests/support/postgres_server.h"

namespace tactus::internal {
namespace {

using testing::Get;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::PostgresServer;
using testing::Put;

// At most half a minute; true if it came about.
template <typename Condition>
bool Eventually(const Condition& condition) {
  for (int i = 0; i < 600; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

class PostgresCatalogTest : public ::testing::Test {
 protected:
  static void TearDownTestSuite() {
    delete server_;
    server_ = nullptr;
  }
  void SetUp() override {
    if (!PostgresServer::IsInstalled()) {
      GTEST_SKIP() << "PostgreSQL is not installed";
    }
    if (server_ == nullptr) server_ = new PostgresServer();
    address_ = server_->NewDatabase();
    auto catalog = OpenPostgresCatalog(address_);
    ASSERT_TRUE(catalog.ok()) << catalog.status();
    catalog_ = *std::move(catalog);
  }

  static inline PostgresServer* server_ = nullptr;
  std::string address_;
  std::unique_ptr<Catalog> catalog_;
};

TEST_F(PostgresCatalogTest, ARecordThatSomebodyChangedIsRefused) {
  ASSERT_TRUE(Put(*catalog_, "a", "1").ok());
  EXPECT_TRUE(catalog_->Check().ok());
  server_->Sql(address_, "UPDATE tactus_records SET value = value || 'x'");
  EXPECT_EQ(ReasonOf(catalog_->Check()), "DATA_LOST");
}

TEST_F(PostgresCatalogTest, ReleasesThatAreNeighboursShareASchema) {
  server_->Sql(address_, "UPDATE tactus_catalog SET version = 2");
  EXPECT_TRUE(OpenPostgresCatalog(address_).ok());
  server_->Sql(address_, "UPDATE tactus_catalog SET oldest_version = 2");
  const absl::Status newer = OpenPostgresCatalog(address_).status();
  EXPECT_EQ(ReasonOf(newer), "DATA_LOST") << newer;
  EXPECT_THAT(std::string(newer.message()), HasSubstr("needs a program"));
}

TEST_F(PostgresCatalogTest, SaysThatTheDatabaseIsAway) {
  const auto none =
      OpenPostgresCatalog("postgresql://ann:secret@127.0.0.1:1/tactus");
  EXPECT_EQ(ReasonOf(none.status()), "CATALOG_UNAVAILABLE");
  EXPECT_TRUE(absl::IsUnavailable(none.status()));
  const std::string text(none.status().message());
  EXPECT_THAT(text, HasSubstr("postgresql://127.0.0.1:1/tactus"));
  EXPECT_THAT(text, Not(HasSubstr("secret")));
}

TEST_F(PostgresCatalogTest, GoesOnWhenTheDatabaseIsBack) {
  ASSERT_TRUE(Put(*catalog_, "a", "1").ok());
  for (const bool killed : {false, true}) {
    killed ? server_->Kill() : server_->Stop();
    EXPECT_EQ(ReasonOf(Put(*catalog_, "a", "2")), "CATALOG_UNAVAILABLE");
    server_->Start();
    EXPECT_EQ(Get(*catalog_, "a"), "1");
  }
  EXPECT_TRUE(Put(*catalog_, "a", "2").ok());
}

TEST_F(PostgresCatalogTest, ADatabaseThatHangsIsNotWaitedFor) {
  ASSERT_TRUE(Put(*catalog_, "a", "1").ok());
  server_->Pause();
  EXPECT_EQ(ReasonOf(Put(*catalog_, "a", "2")), "CATALOG_UNAVAILABLE");
  server_->Continue();
  EXPECT_TRUE(Put(*catalog_, "a", "3").ok());
  EXPECT_EQ(Get(*catalog_, "a"), "3");
}

// Numbers are added one by one while the database is killed again and again, a
// change that is in doubt too: each that returned OK is there once, each that
// failed is there once or not at all.
TEST_F(PostgresCatalogTest, NoChangeIsLostOrMadeTwice) {
  std::atomic<bool> stopping = false;
  std::atomic<int> done = 0;
  std::atomic<int> failed = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      const std::string key = "n" + std::to_string(t);
      while (!stopping) {
        const absl::Status status =
            catalog_->Change([&](Transaction& change) -> absl::Status {
              TACTUS_ASSIGN_OR_RETURN(const auto old,
                                      change.Get(Table::kNumbers, key));
              return change.Put(
                  Table::kNumbers, key,
                  std::to_string(std::stoi(old.value_or("0")) + 1));
            });
        if (!status.ok()) {
          EXPECT_EQ(ReasonOf(status), "CATALOG_UNAVAILABLE") << status;
          ++failed;
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
        } else {
          ++done;
        }
      }
    });
  }
  for (int kill = 0; kill < 4; ++kill) {
    const int before = done;
    EXPECT_TRUE(Eventually([&] { return done > before + 50; }));
    server_->Kill();
    server_->Start();
  }
  const int before = done;
  EXPECT_TRUE(Eventually([&] { return done > before; }));
  stopping = true;
  for (std::thread& thread : threads) thread.join();
  int sum = 0;
  for (const char* key : {"n0", "n1", "n2"}) {
    sum += std::stoi(Get(*catalog_, key, Table::kNumbers).value_or("0"));
  }
  std::printf("%d changes done, %d failed, %d made\n", done.load(),
              failed.load(), sum);
  EXPECT_GE(sum, done);
  EXPECT_LE(sum, done + failed);
  EXPECT_TRUE(catalog_->Check().ok());
}

TEST_F(PostgresCatalogTest, TellsNewsAlsoAfterALoss) {
  std::atomic<int> news = 0;
  const CatalogNews listener(address_, [&](bool) { ++news; });
  // At first, because something may have happened before.
  EXPECT_TRUE(Eventually([&] { return news >= 1; }));
  int before = news;
  ASSERT_TRUE(Put(*catalog_, "a", "1").ok());
  EXPECT_TRUE(Eventually([&] { return news > before; }));
  // A look is no news.
  before = news;
  Get(*catalog_, "a");
  server_->Kill();
  server_->Start();
  EXPECT_TRUE(Eventually([&] { return news > before; }));
  before = news;
  ASSERT_TRUE(Put(*catalog_, "a", "2").ok());
  EXPECT_TRUE(Eventually([&] { return news > before; }));
}

TEST_F(PostgresCatalogTest, SaysWhichNewsIsOfReplicasAlone) {
  std::atomic<int> of_replicas = 0;
  std::atomic<int> of_others = 0;
  const CatalogNews listener(address_, [&](bool of_replicas_alone) {
    ++(of_replicas_alone ? of_replicas : of_others);
  });
  ASSERT_TRUE(Eventually([&] { return of_others == 1; }));
  const auto change = [&](Table table, Table also) {
    return catalog_
        ->Change([&](Transaction& change) -> absl::Status {
          TACTUS_RETURN_IF_ERROR(change.Put(table, "a", "1"));
          return change.Put(also, "a", "1");
        })
        .ok();
  };
  ASSERT_TRUE(change(Table::kReplicas, Table::kBeats));
  EXPECT_TRUE(Eventually([&] { return of_replicas == 1; }));
  ASSERT_TRUE(change(Table::kAliases, Table::kReplicas));
  EXPECT_TRUE(Eventually([&] { return of_others == 2; }));
  // Whoever ends may leave a job.
  ASSERT_TRUE(catalog_
                  ->Change([](Transaction& change) {
                    return change.Erase(Table::kReplicas, "a");
                  })
                  .ok());
  EXPECT_TRUE(Eventually([&] { return of_others == 3; }));
  // Signs of life are no news; what follows them tells.
  ASSERT_TRUE(change(Table::kBeats, Table::kBeats));
  ASSERT_TRUE(change(Table::kReplicas, Table::kBeats));
  EXPECT_TRUE(Eventually([&] { return of_replicas == 2; }));
  EXPECT_EQ(of_others, 3);
}

}  // namespace
}  // namespace tactus::internal
