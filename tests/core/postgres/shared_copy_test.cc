// Copies from a data directory to PostgreSQL and back.
#include "tests/core/postgres/shared_copy.h"

#include <filesystem>

#include "gmock/gmock.h"
#include "tests/support/crash_file_system.h"

namespace tactus::internal {
namespace {

using testing::CrashFileSystem;
using testing::DataFilesBelow;
using testing::FilledFiles;
using testing::Get;
using ::testing::HasSubstr;
using testing::Put;

TEST_F(SharedCopyTest, ThereAndBackAreTheSameRecordsAndFiles) {
  const auto there = CopyIn();
  ASSERT_TRUE(there.ok()) << there.status();
  EXPECT_EQ(Records(*shared_), RecordsOf(from_));
  EXPECT_TRUE(DataFilesBelow(blobs_) == FilledFiles());
  EXPECT_TRUE(Serve().ok());
  const auto back = CopyOut(folder_ / "back");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(RecordsOf(folder_ / "back"), RecordsOf(from_));
  EXPECT_TRUE(DataFilesBelow(folder_ / "back") == FilledFiles());
  EXPECT_EQ(back->records, there->records);
  EXPECT_EQ(back->records_sha256, there->records_sha256);
  EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), folder_ / "back").ok());
}

TEST_F(SharedCopyTest, GoesOnWhereTheCatalogueWentAway) {
  const auto wanted = RecordsOf(from_);
  int resumed = 0;
  int last = 0;
  const int step = testing::StepOfInterruptions();
  for (int k = 1; last == 0; k += step) {
    SCOPED_TRACE(k);
    Clear();
    FailingCatalog failing(shared_.get());
    failing.StopAt(k);
    const absl::Status stopped = CopyIn(PosixFileSystem(), &failing).status();
    if (!failing.failed()) {
      EXPECT_TRUE(stopped.ok()) << stopped;
      last = k;
      continue;
    }
    EXPECT_EQ(ReasonOf(stopped), "CATALOG_UNAVAILABLE");
    if (!Records(*shared_).empty()) {
      EXPECT_THAT(Message(Serve()), HasSubstr("is not finished"));
    }
    const auto report = CopyIn();
    ASSERT_TRUE(report.ok()) << report.status();
    resumed += report->resumed ? 1 : 0;
    ASSERT_EQ(Records(*shared_), wanted);
    ASSERT_TRUE(DataFilesBelow(blobs_) == FilledFiles());
  }
  EXPECT_GT(last, 40);
  EXPECT_GT(resumed * step, last / 2);
}

TEST_F(SharedCopyTest, GoesOnAfterACrashOfTheFolder) {
  const auto wanted = RecordsOf(from_);
  for (int k = 1;; k += testing::StepOfInterruptions()) {
    SCOPED_TRACE(k);
    Clear();
    CrashFileSystem files;
    files.StopAt(k);
    const absl::Status stopped = CopyIn(files).status();
    if (!files.failed()) {
      EXPECT_TRUE(stopped.ok()) << stopped;
      EXPECT_GT(k, 30);
      break;
    }
    files.Lose(CrashFileSystem::kLosses[k % 4]);
    files.Heal();
    const auto report = CopyIn(files);
    if (!report.ok()) {
      EXPECT_THAT(Message(report.status()), HasSubstr("was finished before"));
    }
    ASSERT_EQ(Records(*shared_), wanted);
    ASSERT_TRUE(DataFilesBelow(blobs_) == FilledFiles());
    ASSERT_TRUE(Serve().ok());
  }
}

TEST_F(SharedCopyTest, ADatabaseThatDiesIsMendedByTheNextRun) {
  bool killed = false;
  {
    const auto source = OpenDirectoryToCopy(PosixFileSystem(), from_);
    const auto report =
        CopyData(PosixFileSystem(), (*source)->place(), Shared(),
                 Progress([&](absl::string_view phase, double) {
                   if (phase != "copying records" || killed) return;
                   killed = true;
                   server_->Kill();
                 }));
    EXPECT_EQ(ReasonOf(report.status()), "CATALOG_UNAVAILABLE");
  }
  server_->Start();
  const auto report = CopyIn();
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_TRUE(report->resumed);
  EXPECT_EQ(Records(*shared_), RecordsOf(from_));
}

TEST_F(SharedCopyTest, ATargetWithRecordsIsRefused) {
  ASSERT_TRUE(Put(*shared_, "a", "1", Table::kAliases).ok());
  const absl::Status refused = CopyIn().status();
  EXPECT_THAT(Message(refused), HasSubstr("its catalogue has records"));
  EXPECT_EQ(Get(*shared_, "a", Table::kAliases), "1");
  EXPECT_FALSE(std::filesystem::exists(blobs_ + "/blobs"));
}

// One that is there from the beginning, and one that starts meanwhile.
TEST_F(SharedCopyTest, ServersAtTheCatalogueAreRefused) {
  const auto source = OpenDirectoryToCopy(PosixFileSystem(), from_);
  int calls = 0;
  const auto copy = [&](int first_call) {
    CopyPlace target = Shared();
    calls = 0;
    target.servers = [&calls, first_call] {
      std::vector<std::string> servers;
      if (++calls >= first_call) servers.push_back("replicas/3 (here, here:1)");
      return absl::StatusOr<std::vector<std::string>>(servers);
    };
    return CopyData(PosixFileSystem(), (*source)->place(), target).status();
  };
  EXPECT_THAT(Message(copy(1)), HasSubstr("replicas/3 (here, here:1)"));
  EXPECT_TRUE(Records(*shared_).empty());
  EXPECT_FALSE(std::filesystem::exists(blobs_));
  EXPECT_THAT(Message(copy(2)), HasSubstr("servers are at work"));
  EXPECT_EQ(calls, 2);
  EXPECT_THAT(Message(Serve()), HasSubstr("is not finished"));
  EXPECT_TRUE(copy(3).ok());
  EXPECT_TRUE(Serve().ok());
}

TEST_F(SharedCopyTest, AFolderOfAnotherCatalogueIsRefused) {
  ASSERT_TRUE(Serve().ok());
  auto other = OpenPostgresCatalog(server_->NewDatabase());
  const auto source = OpenDirectoryToCopy(PosixFileSystem(), from_);
  EXPECT_THAT(Message(CopyData(PosixFileSystem(), (*source)->place(),
                               Shared(other->get()))
                          .status()),
              HasSubstr("belongs to another catalogue"));
}

TEST_F(SharedCopyTest, ServersThatStoredNothingLeaveATarget) {
  ASSERT_TRUE(Serve().ok());
  const auto report = CopyIn();
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_TRUE(Serve().ok());
}

TEST_F(SharedCopyTest, MovesToAnotherDatabase) {
  ASSERT_TRUE(CopyIn().ok());
  auto other = OpenPostgresCatalog(server_->NewDatabase());
  const auto moved = CopyData(
      PosixFileSystem(), Shared(),
      {.catalog = other->get(), .folder = folder_ / "other", .shared = true});
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_EQ(Records(**other), RecordsOf(from_));
  EXPECT_TRUE(DataFilesBelow(folder_ / "other") == FilledFiles());
}

TEST_F(SharedCopyTest, AnExistingCatalogueIsOpenedAsItIs) {
  EXPECT_TRUE(OpenExistingPostgresCatalog(address_).ok());
  const std::string empty = server_->NewDatabase();
  const absl::Status refused = OpenExistingPostgresCatalog(empty).status();
  EXPECT_EQ(ReasonOf(refused), "DATA_LOST");
  EXPECT_THAT(Message(refused), HasSubstr("holds no catalogue"));
  server_->Sql(address_, "UPDATE tactus_catalog SET version = 0");
  EXPECT_THAT(Message(OpenExistingPostgresCatalog(address_).status()),
              HasSubstr("start a server"));
  server_->Sql(address_,
               "UPDATE tactus_catalog SET version = 9, oldest_version = 9");
  EXPECT_THAT(Message(OpenExistingPostgresCatalog(address_).status()),
              HasSubstr("version 9"));
}

}  // namespace
}  // namespace tactus::internal
