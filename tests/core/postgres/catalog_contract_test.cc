// What each catalogue does, whatever keeps its records.
#include <atomic>
#include <functional>
#include <thread>

#include "core/base/errors.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/sqlite_catalog.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/catalog_access.h"
#include "tests/support/postgres_server.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using testing::Get;
using ::testing::IsEmpty;
using testing::Keys;
using testing::PostgresServer;
using testing::Put;

enum class Kind { kSqlite, kPostgres };

class CatalogContractTest : public ::testing::TestWithParam<Kind> {
 protected:
  static void TearDownTestSuite() {
    delete server_;
    server_ = nullptr;
  }

  void SetUp() override {
    if (GetParam() == Kind::kSqlite) {
      address_ = folder_ / "catalog.db";
      return;
    }
    if (!PostgresServer::IsInstalled()) {
      GTEST_SKIP() << "PostgreSQL is not installed";
    }
    if (server_ == nullptr) server_ = new PostgresServer();
    address_ = server_->NewDatabase();
  }

  std::unique_ptr<Catalog> Open() const {
    auto catalog = GetParam() == Kind::kSqlite ? OpenSqliteCatalog(address_)
                                               : OpenPostgresCatalog(address_);
    EXPECT_TRUE(catalog.ok()) << catalog.status();
    return *std::move(catalog);
  }

 private:
  static inline PostgresServer* server_ = nullptr;
  ScratchDir folder_;
  std::string address_;
};

TEST_P(CatalogContractTest, KeepsBytes) {
  const std::string bytes("\0\xff'\"\n", 5);
  {
    auto catalog = Open();
    ASSERT_TRUE(Put(*catalog, bytes, bytes).ok());
    ASSERT_TRUE(Put(*catalog, "empty", "").ok());
    ASSERT_TRUE(Put(*catalog, "empty", "other", Table::kAudit).ok());
    ASSERT_TRUE(Put(*catalog, "twice", "1").ok());
    ASSERT_TRUE(Put(*catalog, "twice", "2").ok());
  }
  auto catalog = Open();
  EXPECT_EQ(Get(*catalog, bytes), bytes);
  EXPECT_EQ(Get(*catalog, "empty"), "");
  EXPECT_EQ(Get(*catalog, "empty", Table::kAudit), "other");
  EXPECT_EQ(Get(*catalog, "twice"), "2");
  EXPECT_EQ(Get(*catalog, "no"), std::nullopt);
  EXPECT_TRUE(catalog->Check().ok());
}

TEST_P(CatalogContractTest, ATransactionIsAllOrNothing) {
  auto catalog = Open();
  ASSERT_TRUE(Put(*catalog, "a", "old").ok());
  const absl::Status status = catalog->Change([](Transaction& change) {
    EXPECT_TRUE(change.Put(Table::kTrials, "a", "new").ok());
    EXPECT_TRUE(change.Put(Table::kAudit, "b", "new").ok());
    EXPECT_EQ(*change.Get(Table::kTrials, "a"), "new");
    return IoError("test", "it fails");
  });
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_EQ(Get(*catalog, "a"), "old");
  EXPECT_EQ(Get(*catalog, "b", Table::kAudit), std::nullopt);
  ASSERT_TRUE(catalog
                  ->Change([](Transaction& change) {
                    EXPECT_TRUE(change.Erase(Table::kTrials, "no").ok());
                    return change.Erase(Table::kTrials, "a");
                  })
                  .ok());
  EXPECT_EQ(Get(*catalog, "a"), std::nullopt);
}

TEST_P(CatalogContractTest, ScansInTheOrderOfBytes) {
  auto catalog = Open();
  for (const char* key :
       {"b/2", "b/1", "a", "b", "b0", "c\xff", "c\xff\xff", "\xff", "b/3"}) {
    ASSERT_TRUE(Put(*catalog, key, "").ok());
  }
  EXPECT_THAT(Keys(*catalog, {}),
              ElementsAre("a", "b", "b/1", "b/2", "b/3", "b0", "c\xff",
                          "c\xff\xff", "\xff"));
  EXPECT_THAT(Keys(*catalog, {.prefix = "b/"}),
              ElementsAre("b/1", "b/2", "b/3"));
  EXPECT_THAT(Keys(*catalog, {.prefix = "b/", .backwards = true}),
              ElementsAre("b/3", "b/2", "b/1"));
  EXPECT_THAT(Keys(*catalog, {.prefix = "b/", .after = "b/1"}),
              ElementsAre("b/2", "b/3"));
  EXPECT_THAT(
      Keys(*catalog, {.prefix = "b/", .after = "b/3", .backwards = true}),
      ElementsAre("b/2", "b/1"));
  EXPECT_THAT(Keys(*catalog, {.after = "b/3", .limit = 2}),
              ElementsAre("b0", "c\xff"));
  EXPECT_THAT(Keys(*catalog, {.limit = 1, .backwards = true}),
              ElementsAre("\xff"));
  EXPECT_THAT(Keys(*catalog, {.prefix = "c\xff"}),
              ElementsAre("c\xff", "c\xff\xff"));
  EXPECT_THAT(Keys(*catalog, {.prefix = "\xff"}), ElementsAre("\xff"));
  EXPECT_THAT(Keys(*catalog, {.limit = 0}), IsEmpty());
  EXPECT_THAT(Keys(*catalog, {.prefix = "x"}), IsEmpty());
}

// Adds one to a number.
absl::Status Increment(Catalog& catalog, const std::string& key) {
  return catalog.Change([&](Transaction& change) -> absl::Status {
    TACTUS_ASSIGN_OR_RETURN(const auto old, change.Get(Table::kNumbers, key));
    return change.Put(Table::kNumbers, key,
                      std::to_string(std::stoi(old.value_or("0")) + 1));
  });
}

TEST_P(CatalogContractTest, ChangesAtTheSameTimeAreOneAfterAnother) {
  constexpr int kThreads = 4;
  constexpr int kChanges = 40;
  auto catalog = Open();
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < kChanges; ++i) {
        const absl::Status status = Increment(*catalog, "n");
        EXPECT_TRUE(status.ok()) << status;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(Get(*catalog, "n", Table::kNumbers),
            std::to_string(kThreads * kChanges));
}

// Two records that are always equal: nobody sees one changed and the other not.
TEST_P(CatalogContractTest, ALookIsOneMoment) {
  auto catalog = Open();
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (int i = 0; i < 100; ++i) {
      const std::string number = std::to_string(i);
      EXPECT_TRUE(catalog
                      ->Change([&](Transaction& change) -> absl::Status {
                        TACTUS_RETURN_IF_ERROR(
                            change.Put(Table::kTrials, "a", number));
                        return change.Put(Table::kAudit, "b", number);
                      })
                      .ok());
    }
    done = true;
  });
  int looks = 0;
  while (!done) {
    std::optional<std::string> a, b;
    const absl::Status looked =
        catalog->Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(a, look.Get(Table::kTrials, "a"));
          TACTUS_ASSIGN_OR_RETURN(b, look.Get(Table::kAudit, "b"));
          return absl::OkStatus();
        });
    EXPECT_TRUE(looked.ok()) << looked;
    EXPECT_EQ(a, b);
    ++looks;
  }
  writer.join();
  EXPECT_GT(looks, 0);
}

// Each transaction reads what the other one writes: in one order of the two,
// the second sees the first.
TEST_P(CatalogContractTest, NoTwoChangesMissEachOther) {
  auto catalog = Open();
  for (int round = 0; round < 20; ++round) {
    const std::string prefix = "r" + std::to_string(round) + "/";
    std::vector<std::thread> threads;
    for (const char* own : {"a", "b"}) {
      threads.emplace_back([&, own] {
        EXPECT_TRUE(catalog
                        ->Change([&](Transaction& change) -> absl::Status {
                          TACTUS_ASSIGN_OR_RETURN(
                              const auto others,
                              change.Scan(Table::kTrials, {.prefix = prefix}));
                          return change.Put(Table::kTrials, prefix + own,
                                            std::to_string(others.size()));
                        })
                        .ok());
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_NE(Get(*catalog, prefix + "a"), Get(*catalog, prefix + "b"))
        << prefix;
  }
}

std::string NameOf(const ::testing::TestParamInfo<Kind>& info) {
  return info.param == Kind::kSqlite ? "Sqlite" : "Postgres";
}
INSTANTIATE_TEST_SUITE_P(All, CatalogContractTest,
                         ::testing::Values(Kind::kSqlite, Kind::kPostgres),
                         NameOf);

}  // namespace
}  // namespace tactus::internal
