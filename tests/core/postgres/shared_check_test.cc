// Checks of a catalogue and a folder that servers share.
#include <algorithm>
#include <filesystem>

#include "core/store/data_check.h"
#include "gmock/gmock.h"
#include "tests/core/postgres/shared_copy.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using Severity = CheckResult::Severity;

class SharedCheckTest : public SharedCopyTest {
 protected:
  std::vector<CheckResult> Doctor(std::vector<std::string> servers = {},
                                  bool repair = false) {
    return CheckSharedData(PosixFileSystem(), blobs_,
                           {.catalog = shared_.get(),
                            .address = "the database",
                            .servers = std::move(servers)},
                           {.now_ms = 0, .repair = repair});
  }
  static const CheckResult* Find(const std::vector<CheckResult>& results,
                                 const std::string& check) {
    for (const CheckResult& result : results) {
      if (result.check == check) return &result;
    }
    return nullptr;
  }
  static int Bad(const std::vector<CheckResult>& results) {
    return static_cast<int>(
        std::ranges::count_if(results, [](const CheckResult& result) {
          // What the test's machine has is not of interest.
          return result.severity != Severity::kOk &&
                 result.check != "free disk";
        }));
  }
  std::string Blob(const std::string& bytes) const {
    return BlobPath(blobs_ + "/blobs", Sha256Hex(bytes));
  }
};

TEST_F(SharedCheckTest, FindsNothingWrongWithACopy) {
  ASSERT_TRUE(CopyIn().ok());
  ASSERT_TRUE(Serve().ok());
  const auto results = Doctor();
  for (const CheckResult& result : results) {
    EXPECT_TRUE(result.severity == Severity::kOk || result.check == "free disk")
        << result.check << ": " << result.text;
  }
  EXPECT_THAT(Find(results, "blobs")->text, HasSubstr("7 blobs have their"));
  EXPECT_NE(Find(results, "orphans"), nullptr);
}

TEST_F(SharedCheckTest, NamesEachFault) {
  ASSERT_TRUE(CopyIn().ok());
  WriteBytes(Blob(testing::FilledTrial(1)), "damaged");
  std::filesystem::remove(Blob(testing::FilledModel()));
  WriteBytes(Blob("orphan"), "orphan");
  // What a server removed lies there for a day.
  WriteBytes(blobs_ + "/blobs/removed/" + Sha256Hex("orphan"), "orphan");
  WriteBytes(blobs_ + "/uploads/99", "stray");
  std::filesystem::create_directories(blobs_ + "/jobs/7");
  auto results = Doctor();
  const CheckResult* blobs = Find(results, "blobs");
  EXPECT_EQ(blobs->severity, Severity::kError);
  EXPECT_THAT(blobs->text, HasSubstr("2 of 7"));
  EXPECT_THAT(blobs->text,
              HasSubstr(Sha256Hex(testing::FilledTrial(1)) + " is damaged"));
  EXPECT_THAT(blobs->text,
              HasSubstr(Sha256Hex(testing::FilledModel()) + " is missing"));
  for (const char* check : {"orphans", "stray uploads", "jobs"}) {
    EXPECT_EQ(Find(results, check)->severity, Severity::kWarning) << check;
  }
  EXPECT_THAT(Find(results, "orphans")->text, HasSubstr("1 blobs"));
  EXPECT_TRUE(std::filesystem::exists(Blob("orphan")));
  // A repair moves them away, and deletes nothing.
  results = Doctor({}, /*repair=*/true);
  EXPECT_FALSE(std::filesystem::exists(Blob("orphan")));
  EXPECT_EQ(ReadBytes(blobs_ + "/lost+found/1/uploads/99"), "stray");
  EXPECT_EQ(Bad(Doctor()), 1);
  // A record that another program changed.
  server_->Sql(address_,
               "UPDATE tactus_records SET value = 'x' WHERE kind = 3");
  results = Doctor();
  EXPECT_EQ(Find(results, "records")->severity, Severity::kError);
  EXPECT_THAT(Find(results, "records")->text, HasSubstr("trials"));
  EXPECT_THAT(Find(results, "orphans")->text, HasSubstr("not checked"));
}

TEST_F(SharedCheckTest, LooksWhileServersAreAtWork) {
  ASSERT_TRUE(CopyIn().ok());
  WriteBytes(Blob("orphan"), "orphan");
  auto results = Doctor({"replicas/1 (here, here:1)"}, /*repair=*/true);
  EXPECT_EQ(Find(results, "lock")->severity, Severity::kWarning);
  EXPECT_EQ(Find(results, "blobs")->severity, Severity::kOk);
  // It may be named in a moment.
  EXPECT_EQ(Find(results, "orphans"), nullptr);
  EXPECT_TRUE(std::filesystem::exists(Blob("orphan")));
  std::filesystem::remove(Blob(testing::FilledModel()));
  results = Doctor({"replicas/1 (here, here:1)"});
  EXPECT_EQ(Find(results, "blobs")->severity, Severity::kError);
}

TEST_F(SharedCheckTest, RefusesTheWrongFolderAndAnUnfinishedCopy) {
  ASSERT_TRUE(CopyIn().ok());
  const auto wrong = [&](const std::string& folder) {
    const auto results = CheckSharedData(
        PosixFileSystem(), folder, {.catalog = shared_.get()}, {.now_ms = 0});
    EXPECT_EQ(Find(results, "catalogue")->severity, Severity::kError) << folder;
    EXPECT_EQ(Find(results, "blobs"), nullptr);
  };
  wrong(folder_ / "none");
  wrong(from_);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  Clear();
  FailingCatalog failing(shared_.get());
  failing.StopAt(10);
  EXPECT_FALSE(CopyIn(PosixFileSystem(), &failing).ok());
  ASSERT_TRUE(failing.failed());
  wrong(blobs_);
}

}  // namespace
}  // namespace tactus::internal
