// A server whose catalogue was lost began with an empty one, without a word,
// and `trainctl doctor --repair` then deleted all blobs, because nothing named
// them. Records that another program removed from the catalogue went unnoticed.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/store/data_check.h"
#include "core/store/sqlite_catalog.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/old_directory.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Severity = CheckResult::Severity;

class RepairTest : public ::testing::Test {
 protected:
  // A directory with a dataset of three trials, a model and an upload.
  RepairTest() {
    Fill(path_);
    blobs_ = BlobsIn(path_ + "/blobs");
    EXPECT_EQ(blobs_.size(), 5u);
  }
  static void Fill(const std::string& path) {
    Stores stores(&PosixFileSystem(), path);
    EXPECT_TRUE(stores.datasets->Create(kDataset, "", kCaller).ok());
    EXPECT_TRUE(stores.Upload(Pack(0, 3)).ok());
    EXPECT_TRUE(
        stores.models->AddVersion("models/m", TestBundle(1), {}, kCaller).ok());
    const auto upload = stores.uploads->Create(kDataset, "", false, kCaller);
    EXPECT_TRUE(stores.Write(upload->name(), std::string(100, 'x'), 100).ok());
  }
  // The blobs below `folder`, wherever they are, whose bytes are right.
  static std::set<std::string> BlobsIn(const std::string& folder) {
    std::set<std::string> blobs;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = entry.path().filename();
      if (IsSha256Hex(name) && Sha256Hex(ReadBytes(entry.path())) == name) {
        blobs.insert(name);
      }
    }
    return blobs;
  }
  void Sql(const std::string& sql) const { RunSql(path_, sql); }
  absl::Status Open() const {
    return DataDirectory::Open(PosixFileSystem(), path_).status();
  }
  std::map<std::string, CheckResult> Check(DataCheckOptions options) const {
    options.free_bytes = [](const std::string&) { return int64_t{1} << 40; };
    std::map<std::string, CheckResult> worst;
    for (const CheckResult& result :
         CheckData(PosixFileSystem(), path_, options)) {
      const auto [place, isnew] = worst.try_emplace(result.check, result);
      if (!isnew && result.severity > place->second.severity) {
        place->second = result;
      }
    }
    return worst;
  }
  // The server does not start and says what to do, a repair changes nothing.
  void ExpectRefused() const {
    const absl::Status status = Open();
    EXPECT_TRUE(absl::IsDataLoss(status)) << status;
    EXPECT_THAT(std::string(status.message()),
                AllOf(HasSubstr("Put back catalog.db"),
                      HasSubstr("--accept-catalogue")));
    const auto results = Check({.repair = true});
    ASSERT_TRUE(results.contains("catalogue"));
    EXPECT_EQ(results.at("catalogue").severity, Severity::kError);
    EXPECT_FALSE(results.contains("orphans"));
    EXPECT_EQ(BlobsIn(path_ + "/blobs"), blobs_);
    EXPECT_TRUE(fs::exists(path_ + "/uploads/2"));
    EXPECT_FALSE(fs::exists(path_ + "/lost+found"));
  }

  ScratchDir folder_;
  const std::string path_ = folder_ / "data";
  std::set<std::string> blobs_;
};

TEST_F(RepairTest, AMissingCatalogueIsRefused) {
  fs::remove(path_ + "/catalog.db");
  ExpectRefused();
  EXPECT_FALSE(fs::exists(path_ + "/catalog.db"));
}

TEST_F(RepairTest, AnEmptyFileIsRefused) {
  WriteBytes(path_ + "/catalog.db", "");
  ExpectRefused();
}

TEST_F(RepairTest, ANewCatalogueIsRefused) {
  fs::remove(path_ + "/catalog.db");
  { ASSERT_TRUE(OpenSqliteCatalog(path_ + "/catalog.db").ok()); }
  ExpectRefused();
}

TEST_F(RepairTest, AnEmptyDatabaseIsRefused) {
  fs::remove(path_ + "/catalog.db");
  Sql("VACUUM; PRAGMA journal_mode = WAL");
  ExpectRefused();
}

TEST_F(RepairTest, TheCatalogueOfAnotherDirectoryIsRefused) {
  const std::string other = folder_ / "other";
  Fill(other);
  fs::copy_file(other + "/catalog.db", path_ + "/catalog.db",
                fs::copy_options::overwrite_existing);
  ExpectRefused();
}

TEST_F(RepairTest, ATruncatedCatalogueIsRefused) {
  const std::string whole = ReadBytes(path_ + "/catalog.db");
  for (const size_t size : {size_t{1}, size_t{99}, size_t{511}, size_t{4096},
                            whole.size() / 2, whole.size() - 1}) {
    SCOPED_TRACE(size);
    WriteBytes(path_ + "/catalog.db", whole.substr(0, size));
    ExpectRefused();
  }
  WriteBytes(path_ + "/catalog.db", whole);
  EXPECT_TRUE(Open().ok());
}

TEST_F(RepairTest, RecordsThatAnotherProgramRemovedAreMissed) {
  const std::string whole = ReadBytes(path_ + "/catalog.db");
  for (const char* sql :
       {"DROP TABLE records", "DROP TABLE tallies", "DELETE FROM records",
        "DELETE FROM records; DELETE FROM tallies",
        "DELETE FROM records WHERE kind = 1",
        "DELETE FROM records WHERE kind = 2",
        "DELETE FROM records WHERE kind = 3 AND key = (SELECT MIN(key) FROM "
        "records WHERE kind = 3)",
        "DELETE FROM records WHERE kind = 4",
        "DELETE FROM records WHERE kind = 7",
        "DELETE FROM records WHERE kind = 11",
        "DELETE FROM records WHERE kind = 14",
        "UPDATE records SET value = (SELECT MAX(value) FROM records WHERE kind "
        "= 3) WHERE kind = 3",
        "INSERT INTO records SELECT kind, key || 'x', value FROM records WHERE "
        "kind = 1",
        "PRAGMA user_version = 0"}) {
    SCOPED_TRACE(sql);
    WriteBytes(path_ + "/catalog.db", whole);
    Sql(sql);
    ExpectRefused();
  }
  WriteBytes(path_ + "/catalog.db", whole);
  EXPECT_TRUE(Open().ok());
}

TEST_F(RepairTest, AnOldDirectoryGetsAMarkerAndThenMissesItsCatalogue) {
  MakeOldDirectory(path_);
  ASSERT_TRUE(Open().ok());
  EXPECT_TRUE(fs::exists(path_ + "/marker"));
  ASSERT_TRUE(Open().ok());
  EXPECT_EQ(Check({.repair = true}).at("catalogue").severity, Severity::kOk);
  fs::remove(path_ + "/catalog.db");
  ExpectRefused();
}

TEST_F(RepairTest, AnOldDirectoryWithoutItsCatalogueIsRefused) {
  MakeOldDirectory(path_);
  fs::remove(path_ + "/catalog.db");
  ExpectRefused();
  Sql("CREATE TABLE records (kind INTEGER NOT NULL, key BLOB NOT NULL, value "
      "BLOB NOT NULL, PRIMARY KEY (kind, key)) WITHOUT ROWID; "
      "PRAGMA user_version = 1");
  // The doctor leaves an old catalogue to the server.
  EXPECT_TRUE(absl::IsDataLoss(Open()));
  ExpectRefused();
}

TEST_F(RepairTest, ARepairDeletesNothing) {
  const std::string orphan = Sha256Hex("orphan");
  const std::string shelf = path_ + "/blobs/" + orphan.substr(0, 2) + "/";
  WriteBytes(shelf + orphan, "orphan");
  fs::create_directories(path_ + "/jobs/9/parts");
  WriteBytes(path_ + "/jobs/9/parts/hmm", "part");
  WriteBytes(path_ + "/uploads/77", "upload");
  auto results = Check({.repair = true});
  EXPECT_THAT(results.at("orphans").text, HasSubstr("lost+found/1"));
  EXPECT_THAT(results.at("lost+found").text, HasSubstr("rm -r"));
  const std::string lost = path_ + "/lost+found/1/";
  EXPECT_EQ(ReadBytes(lost + "blobs/" + orphan.substr(0, 2) + "/" + orphan),
            "orphan");
  EXPECT_EQ(ReadBytes(lost + "jobs/9/parts/hmm"), "part");
  EXPECT_EQ(ReadBytes(lost + "uploads/77"), "upload");
  EXPECT_EQ(BlobsIn(path_ + "/blobs"), blobs_);
  // A second one does not touch what the first one moved.
  WriteBytes(shelf + orphan, "orphan");
  Check({.repair = true});
  EXPECT_TRUE(fs::exists(path_ + "/lost+found/2"));
  EXPECT_TRUE(fs::exists(lost + "uploads/77"));
}

// What was stored after the copy was made is named by no record.
TEST_F(RepairTest, AnOlderCatalogueLosesNoBlob) {
  fs::copy_file(path_ + "/catalog.db", folder_ / "copy.db");
  {
    Stores stores(&PosixFileSystem(), path_);
    ASSERT_TRUE(stores.Upload(Pack(3, 6)).ok());
    const auto upload = stores.uploads->Create(kDataset, "", false, kCaller);
    ASSERT_EQ(upload->name(), "uploads/4");
    ASSERT_TRUE(stores.Write(upload->name(), "waiting", 7).ok());
  }
  const auto all = BlobsIn(path_ + "/blobs");
  ASSERT_GT(all.size(), blobs_.size());
  fs::copy_file(folder_ / "copy.db", path_ + "/catalog.db",
                fs::copy_options::overwrite_existing);
  EXPECT_EQ(Check({}).at("catalogue").severity, Severity::kWarning);
  {
    Stores stores(&PosixFileSystem(), path_);
    EXPECT_TRUE(stores.data->catalog_is_older());
    EXPECT_TRUE(stores.uploads->RemoveAbandoned().ok());
    EXPECT_EQ(stores.uploads->Create(kDataset, "", false, kCaller)->name(),
              "uploads/3");
  }
  EXPECT_EQ(ReadBytes(path_ + "/lost+found/1/uploads/4"), "waiting");
  EXPECT_EQ(Check({.repair = true}).at("orphans").severity, Severity::kOk);
  EXPECT_EQ(BlobsIn(path_ + "/blobs"), blobs_);
  EXPECT_EQ(BlobsIn(path_), all);
  EXPECT_FALSE(
      (*DataDirectory::Open(PosixFileSystem(), path_))->catalog_is_older());
}

// The log of a server that was killed holds all since it began.
TEST_F(RepairTest, ALostWriteAheadLogIsNoticed) {
  const std::string killed = folder_ / "killed";
  {
    Stores stores(&PosixFileSystem(), path_);
    ASSERT_TRUE(stores.Upload(Pack(3, 6)).ok());
    fs::copy(path_, killed, fs::copy_options::recursive);
  }
  ASSERT_TRUE(fs::exists(killed + "/catalog.db-wal"));
  fs::remove(killed + "/catalog.db-wal");
  fs::remove(killed + "/catalog.db-shm");
  const auto opened = DataDirectory::Open(PosixFileSystem(), killed);
  ASSERT_TRUE(opened.ok()) << opened.status();
  EXPECT_TRUE((*opened)->catalog_is_older());
}

TEST_F(RepairTest, ABackUpWithoutTheMarkerOpens) {
  const std::string restored = folder_ / "restored";
  fs::create_directory(restored);
  fs::copy(path_ + "/blobs", restored + "/blobs", fs::copy_options::recursive);
  fs::copy_file(path_ + "/catalog.db", restored + "/catalog.db");
  const auto opened = DataDirectory::Open(PosixFileSystem(), restored);
  ASSERT_TRUE(opened.ok()) << opened.status();
  EXPECT_FALSE((*opened)->catalog_is_older());
}

TEST_F(RepairTest, ThereIsAWayOutWithoutABackUp) {
  const std::string good = ReadBytes(path_ + "/catalog.db");
  const std::string other = folder_ / "other";
  Fill(other);
  const std::string wrong = ReadBytes(other + "/catalog.db");
  for (const std::string& bytes :
       {std::string(), std::string(8192, 'x'), good.substr(0, 4096), wrong}) {
    SCOPED_TRACE(bytes.size());
    WriteBytes(path_ + "/catalog.db", bytes);
    ExpectRefused();
    EXPECT_EQ(Check({.accept_catalog = true}).at("catalogue").severity,
              Severity::kOk);
    EXPECT_EQ(BlobsIn(path_ + "/blobs"), blobs_);
    EXPECT_TRUE(Open().ok());
    if (fs::exists(path_ + "/lost+found")) {
      EXPECT_EQ(ReadBytes(path_ + "/lost+found/1/catalog.db"), bytes);
      fs::remove_all(path_ + "/lost+found");
    }
  }
  WriteBytes(path_ + "/catalog.db", good);
  Sql("DELETE FROM records WHERE kind = 7");
  ExpectRefused();
  Check({.accept_catalog = true});
  const Stores stores(&PosixFileSystem(), path_);
  EXPECT_EQ(stores.datasets->Version(kDataset)->trials(), 3u);
}

TEST_F(RepairTest, AnUnusedDirectoryStartsAfresh) {
  const std::string path = folder_ / "new";
  fs::create_directories(path + "/blobs/ab");
  fs::create_directories(path + "/uploads");
  WriteBytes(path + "/catalog.db", "");
  EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), path).ok());
  EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), path).ok());
}

TEST_F(RepairTest, AMarkerThatCannotBeReadStillSaysThatTheFolderWasUsed) {
  WriteBytes(path_ + "/marker", "");
  EXPECT_TRUE(Open().ok());
  EXPECT_THAT(ReadBytes(path_ + "/marker"), Not(""));
  WriteBytes(path_ + "/marker", "?");
  fs::remove(path_ + "/catalog.db");
  ExpectRefused();
}

}  // namespace
}  // namespace tactus::internal::server
