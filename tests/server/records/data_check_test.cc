#include "core/store/data_check.h"

#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::HasSubstr;
using Severity = CheckResult::Severity;

constexpr int64_t kMuch = 1L << 40;

class DataCheckTest : public ::testing::Test {
 protected:
  // A dataset of three trials and an unfinished upload of 100 bytes.
  DataCheckTest() {
    Stores stores(&PosixFileSystem(), path_);
    EXPECT_TRUE(stores.datasets->Create(kDataset, "", kCaller).ok());
    EXPECT_TRUE(stores.Upload(Pack(0, 3)).ok());
    EXPECT_TRUE(
        stores.models->AddVersion("models/m", TestBundle(1), {}, kCaller).ok());
    const auto upload = stores.uploads->Create(kDataset, "", false, kCaller);
    EXPECT_TRUE(stores.Write(upload->name(), std::string(100, 'x'), 100).ok());
    upload_time_ms_ = stores.time_ms;
    blob_ = Sha256Hex(TestBundle(1));
    EXPECT_TRUE(std::filesystem::exists(BlobPath(blob_)));
  }

  // Results by the name of their check; the worst if there are several.
  std::map<std::string, CheckResult> Check(bool repair = false,
                                           int64_t age_ms = 0,
                                           int64_t free = kMuch) {
    std::map<std::string, CheckResult> worst;
    for (const CheckResult& result :
         CheckData(PosixFileSystem(), path_,
                   {.now_ms = upload_time_ms_ + age_ms,
                   .repair = repair,
                   .free_bytes = [=](const std::string&) { return free; }})) {
      const auto [place, isnew] = worst.try_emplace(result.check, result);
      if (!isnew && result.severity > place->second.severity) {
        place->second = result;
      }
    }
    return worst;
  }
  static void ExpectAllWell(const std::map<std::string, CheckResult>& results) {
    for (const auto& [name, result] : results) {
      EXPECT_EQ(result.severity, Severity::kOk) << name << ": " << result.text;
      EXPECT_EQ(result.advice, "") << name;
    }
    EXPECT_TRUE(results.contains("blobs"));
  }
  std::string BlobPath(const std::string& sha256) const {
    return path_ + "/blobs/" + sha256.substr(0, 2) + "/" + sha256;
  }
  static void Write(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  void Sql(const char* sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((path_ + "/catalog.db").c_str(), &database),
              SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(database);
  }

  ScratchDir folder_;
  const std::string path_ = folder_ / "data";
  int64_t upload_time_ms_ = 0;
  std::string blob_;
};

TEST_F(DataCheckTest, AGoodDirectoryIsWell) {
  ExpectAllWell(Check());
  ExpectAllWell(Check(/*repair=*/true));
  // Nothing was lost by that.
  const Stores stores(&PosixFileSystem(), path_);
  EXPECT_EQ(
      stores.datasets->Trials(*stores.datasets->Version(kDataset))->size(), 3u);
  EXPECT_EQ(stores.uploads->Get("uploads/2")->committed_size(), 100);
}

TEST_F(DataCheckTest, AFolderWithoutACatalogueStaysAsItIs) {
  const std::string empty = folder_ / "empty";
  std::filesystem::create_directory(empty);
  const auto results = CheckData(PosixFileSystem(), empty, {});
  EXPECT_EQ(results.back().check, "catalogue");
  EXPECT_EQ(results.back().severity, Severity::kError);
  EXPECT_TRUE(std::filesystem::is_empty(empty));
}

TEST_F(DataCheckTest, AServerHoldsTheDirectory) {
  const Stores server(&PosixFileSystem(), path_);
  const auto results = Check();
  EXPECT_EQ(results.at("lock").severity, Severity::kWarning);
  EXPECT_THAT(results.at("lock").text, HasSubstr("another process"));
  EXPECT_FALSE(results.contains("blobs"));
}

TEST_F(DataCheckTest, AMissingBlobIsAnError) {
  std::filesystem::remove(BlobPath(blob_));
  const auto result = Check(/*repair=*/true).at("blobs");
  EXPECT_EQ(result.severity, Severity::kError);
  EXPECT_THAT(result.text, HasSubstr(blob_ + " is missing"));
}

TEST_F(DataCheckTest, ADamagedBlobIsAnErrorAndStays) {
  Write(BlobPath(blob_), "other");
  const auto results = Check(/*repair=*/true);
  EXPECT_EQ(results.at("blobs").severity, Severity::kError);
  EXPECT_THAT(results.at("blobs").text, HasSubstr(blob_ + " is damaged"));
  EXPECT_TRUE(std::filesystem::exists(BlobPath(blob_)));
}

TEST_F(DataCheckTest, AWrongChecksumIsAnErrorAndNothingIsMoved) {
  Sql("UPDATE records SET value = x'00' || value WHERE kind = 7");
  const std::string orphan = BlobPath(Sha256Hex("orphan"));
  Write(orphan, "orphan");
  const auto results = Check(/*repair=*/true);
  EXPECT_EQ(results.at("records").severity, Severity::kError);
  EXPECT_THAT(results.at("records").text, HasSubstr("model versions"));
  EXPECT_EQ(results.at("orphans").severity, Severity::kWarning);
  EXPECT_TRUE(std::filesystem::exists(orphan));
  EXPECT_TRUE(std::filesystem::exists(BlobPath(blob_)))
      << "the record that names it cannot be read";
}

TEST_F(DataCheckTest, OtherVersionsOfTheCatalogueStayAsTheyAre) {
  Sql("PRAGMA user_version = 99");
  EXPECT_EQ(Check().at("catalogue").severity, Severity::kError);
  Sql("PRAGMA user_version = 0");
  EXPECT_EQ(Check().at("catalogue").severity, Severity::kError);
  Sql("PRAGMA user_version = 1");
  EXPECT_EQ(Check().at("catalogue").severity, Severity::kWarning);
  Sql("PRAGMA user_version = 2");
  ExpectAllWell(Check());
}

TEST_F(DataCheckTest, ADamagedCatalogueIsAnError) {
  Write(path_ + "/catalog.db", std::string(8192, 'x'));
  EXPECT_EQ(Check().at("catalogue").severity, Severity::kError);
}

TEST_F(DataCheckTest, OrphansAreFoundAndMoved) {
  const std::string paths[] = {BlobPath(Sha256Hex("orphan")),
                               path_ + "/blobs/drafts/0-draft",
                               path_ + "/uploads/77"};
  for (const std::string& path : paths) Write(path, "orphan");
  std::filesystem::create_directories(path_ + "/jobs/9/parts");
  Write(path_ + "/jobs/9/log", "1234567");
  auto results = Check();
  EXPECT_THAT(results.at("orphans").text, HasSubstr("2 blobs"));
  EXPECT_THAT(results.at("orphans").text, HasSubstr("12 B"));
  EXPECT_THAT(results.at("stray uploads").text, HasSubstr("6 B"));
  EXPECT_THAT(results.at("jobs").text, HasSubstr("7 B"));
  for (const char* check : {"orphans", "stray uploads", "jobs"}) {
    EXPECT_EQ(results.at(check).severity, Severity::kWarning) << check;
    EXPECT_THAT(results.at(check).advice, HasSubstr("--repair"));
  }
  for (const std::string& path : paths) {
    EXPECT_TRUE(std::filesystem::exists(path)) << path;
  }
  results = Check(/*repair=*/true);
  EXPECT_THAT(results.at("orphans").text, HasSubstr("moved to"));
  for (const std::string& path : paths) {
    EXPECT_FALSE(std::filesystem::exists(path)) << path;
  }
  EXPECT_FALSE(std::filesystem::exists(path_ + "/jobs/9"));
  ExpectAllWell(Check());
}

TEST_F(DataCheckTest, TheFolderOfAJobThatWaitsStays) {
  {
    const Stores stores(&PosixFileSystem(), path_);
    EXPECT_EQ(stores.operations->Create({}, "", kCaller)->name(),
              "operations/1");
  }
  std::filesystem::create_directories(path_ + "/jobs/1");
  ExpectAllWell(Check(/*repair=*/true));
  EXPECT_TRUE(std::filesystem::exists(path_ + "/jobs/1"));
}

TEST_F(DataCheckTest, AbandonedUploadsAreFoundAndMoved) {
  constexpr int64_t kWeek = limits::kAbandonedUploadMs;
  ExpectAllWell(Check(/*repair=*/true, kWeek - 1));
  const auto found = Check(/*repair=*/false, kWeek).at("abandoned uploads");
  EXPECT_EQ(found.severity, Severity::kWarning);
  EXPECT_THAT(found.text, HasSubstr("100 B: uploads/2"));
  EXPECT_THAT(Check(/*repair=*/true, kWeek).at("abandoned uploads").text,
              HasSubstr("moved to"));
  ExpectAllWell(Check(/*repair=*/false, kWeek));
  Stores stores(&PosixFileSystem(), path_);
  EXPECT_FALSE(stores.uploads->Get("uploads/2").ok());
  EXPECT_EQ(stores.uploads->Create(kDataset, "", false, kCaller)->name(),
            "uploads/3");
}

TEST_F(DataCheckTest, AnUploadThatLostBytesIsAnError) {
  Write(path_ + "/uploads/2", "short");
  const auto result = Check(/*repair=*/true).at("uploads");
  EXPECT_EQ(result.severity, Severity::kError);
  EXPECT_THAT(result.text, HasSubstr("uploads/2 has 5 of 100 bytes"));
}

TEST_F(DataCheckTest, AFullDiskIsReported) {
  EXPECT_EQ(Check(false, 0, 500'000'000).at("free disk").severity,
            Severity::kWarning);
  EXPECT_EQ(Check(false, 0, 5'000).at("free disk").severity, Severity::kError);
}

}  // namespace
}  // namespace tactus::internal::server
