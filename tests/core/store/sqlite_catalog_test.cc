#include "core/store/sqlite_catalog.h"

#include <sqlite3.h>

#include <map>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/catalog_access.h"
#include "tests/support/crash_vfs.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::CrashFileSystem;
using testing::CrashVfs;
using testing::Get;
using testing::Put;
using testing::Scan;
using Loss = CrashFileSystem::Loss;

std::unique_ptr<Catalog> Open(const std::string& path,
                              const std::string& vfs = "") {
  auto catalog = OpenSqliteCatalog(path, vfs);
  EXPECT_TRUE(catalog.ok()) << catalog.status();
  return *std::move(catalog);
}

class SqliteCatalogTest : public ::testing::Test {
 protected:
  // Runs SQL on the file behind the catalogue's back.
  void Sql(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(database);
  }

  ScratchDir folder_;
  const std::string path_ = folder_ / "catalog.db";
};

TEST_F(SqliteCatalogTest, OtherVersionsAreRefused) {
  { ASSERT_TRUE(Put(*Open(path_), "a", "1").ok()); }
  for (const int version : {kCatalogVersion + 1, 2147483647, -1, -2147483647}) {
    Sql("PRAGMA user_version = " + std::to_string(version));
    EXPECT_EQ(ReasonOf(OpenSqliteCatalog(path_).status()), "DATA_LOST")
        << version;
  }
  Sql("PRAGMA user_version = " + std::to_string(kCatalogVersion));
  EXPECT_EQ(Get(*Open(path_), "a"), "1");
}

TEST_F(SqliteCatalogTest, WhatIsNoDatabaseIsRefused) {
  WriteBytes(path_, std::string(5000, 'x'));
  EXPECT_EQ(ReasonOf(OpenSqliteCatalog(path_).status()), "DATA_LOST");
  EXPECT_EQ(ReasonOf(OpenSqliteCatalog(folder_.path()).status()), "IO");
  EXPECT_EQ(ReasonOf(OpenSqliteCatalog(folder_ / "no/catalog.db").status()),
            "IO");
}

// What becomes of damaged databases.
class DamagedCatalogTest : public SqliteCatalogTest {
 protected:
  static constexpr size_t kPage = 4096;

  DamagedCatalogTest() {
    Random random(7);
    {
      auto catalog = Open(path_);
      for (int i = 0; i < 60; ++i) {
        std::string value(random.Index(300), '\0');
        for (char& c : value) c = static_cast<char>(random.Index(256));
        const std::string key = "key-" + std::to_string(i);
        records_[key] = value;
        EXPECT_TRUE(Put(*catalog, key, value).ok());
      }
    }
    good_ = ReadBytes(path_);
    EXPECT_FALSE(std::filesystem::exists(path_ + "-wal"));
  }

  // Changes the bits `flip` of a byte. The database is refused as damaged, by
  // Open, Check or, if there are records in its page, the read of the record;
  // or the damage lies where no record is, and all records are as they were.
  void Flip(size_t place, uint64_t flip) {
    SCOPED_TRACE("byte " + std::to_string(place) + ", bits " +
                 std::to_string(flip));
    std::string bad = good_;
    bad[place] = static_cast<char>(bad[place] ^ flip);
    for (const char* tail : {"-wal", "-shm"}) {
      std::filesystem::remove(path_ + tail);
    }
    WriteBytes(path_, bad);
    ++flips_;
    const auto catalog = OpenSqliteCatalog(path_);
    absl::Status status = catalog.status();
    if (status.ok()) status = (*catalog)->Check();
    std::map<std::string, std::string> read;
    if (status.ok()) {
      const bool has_records = place >= kPage;
      for (const CatalogEntry& entry :
           Scan(**catalog, {}, Table::kTrials, &status)) {
        read[entry.key] = entry.value;
      }
      EXPECT_TRUE(status.ok() || has_records) << status;
    }
    if (status.ok()) {
      EXPECT_EQ(read, records_);
    } else {
      EXPECT_EQ(ReasonOf(status), "DATA_LOST") << status;
      ++refused_;
    }
  }
  void Report() {
    RecordProperty("flips", flips_);
    RecordProperty("refused", refused_);
    std::printf("%d of %d flips were refused\n", refused_, flips_);
  }

  std::map<std::string, std::string> records_;
  std::string good_;
  int flips_ = 0;
  int refused_ = 0;
};

TEST_F(DamagedCatalogTest, NoFlippedByteChangesARecord) {
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    Flip(random.Index(good_.size()), 1 + random.Index(255));
  }
  Report();
  EXPECT_GT(refused_, 20);
}

// The first page says what the file is, and holds the schema. In between there
// is room that nothing uses; of it every tenth byte, or all with TACTUS_LONG.
TEST_F(DamagedCatalogTest, NoFlippedByteOfTheFirstPageChangesARecord) {
  constexpr size_t kHeader = 120;
  ASSERT_EQ(good_.substr(0, 16), std::string("SQLite format 3\0", 16));
  const size_t stride = std::getenv("TACTUS_LONG") == nullptr ? 10 : 1;
  for (size_t i = 0; i < kPage;) {
    for (const int flip : {1 << (i % 8), 255}) Flip(i, flip);
    i += i < kHeader || good_[i] != 0 ? 1 : stride;
  }
  Report();
  EXPECT_GT(refused_, 200);
}

// For each operation of SQLite's and each loss: every change is there or not,
// in order, and those that returned OK are there.
TEST_F(SqliteCatalogTest, CrashAtEachOperation) {
  constexpr int kChanges = 4;
  int points = 0;
  for (const Loss loss : CrashFileSystem::kLosses) {
    bool reached = true;
    for (int k = 1; reached; ++k) {
      for (const char* tail : {"", "-wal", "-shm", "-journal"}) {
        std::filesystem::remove(path_ + tail);
      }
      CrashFileSystem files;
      const CrashVfs vfs(&files);
      int acknowledged = 0;
      {
        auto catalog = Open(path_, vfs.name());
        ASSERT_TRUE(files.SyncDirectory(folder_.path()).ok());
        files.StopAt(k);
        for (int i = 1; i <= kChanges; ++i) {
          const bool done =
              catalog
                  ->Change([&](Transaction& change) -> absl::Status {
                    const std::string number = std::to_string(i);
                    TACTUS_RETURN_IF_ERROR(
                        change.Put(Table::kTrials, "last", number));
                    return change.Put(Table::kAudit, number,
                                      std::string(1000, 'x'));
                  })
                  .ok();
          if (done) acknowledged = i;
        }
        reached = files.failed();
      }
      files.Lose(loss);
      files.Heal();
      auto catalog = Open(path_, vfs.name());
      ASSERT_TRUE(catalog->Check().ok());
      const std::string last = Get(*catalog, "last").value_or("0");
      EXPECT_GE(std::stoi(last), acknowledged) << "operation " << k;
      EXPECT_EQ(Scan(*catalog, {}, Table::kAudit).size(),
                static_cast<size_t>(std::stoi(last)))
          << "operation " << k;
      ASSERT_TRUE(Put(*catalog, "last", "9").ok());
      ++points;
    }
  }
  RecordProperty("points", points);
  EXPECT_GT(points, 40);
}

TEST_F(SqliteCatalogTest, AnErrorOfTheDiskLeavesTheOldState) {
  CrashFileSystem files;
  const CrashVfs vfs(&files);
  auto catalog = Open(path_, vfs.name());
  ASSERT_TRUE(Put(*catalog, "a", "0").ok());
  for (const absl::Status& error :
       {StorageFull("disk", "no room"), IoError("disk", "error")}) {
    bool reached = true;
    for (int n = 1; reached; ++n) {
      const std::string before = *Get(*catalog, "a");
      const std::string next = before + "1";
      files.FailAt(n, error);
      const absl::Status status = Put(*catalog, "a", next);
      reached = files.failed();
      files.Heal();
      EXPECT_EQ(Get(*catalog, "a"), status.ok() ? next : before) << n;
      if (!status.ok()) {
        EXPECT_EQ(ReasonOf(status), ReasonOf(error)) << status;
      }
      EXPECT_TRUE(Put(*catalog, "a", next).ok()) << n;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
