// Copies of all data, from one data directory to another.
#include "core/store/data_copy.h"

#include <filesystem>

#include "core/base/errors.h"
#include "core/store/blob_store.h"
#include "core/store/copy_mark.h"
#include "core/store/copy_records.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_to_copy.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/catalog_access.h"
#include "tests/support/crash_vfs.h"
#include "tests/support/filled_data.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::CrashFileSystem;
using testing::CrashVfs;
using testing::DataFilesBelow;
using testing::FilesBelow;
using testing::FilledFiles;
using testing::Get;
using ::testing::HasSubstr;
using testing::Put;
using testing::Scan;

std::string Said(const absl::Status& status) {
  return std::string(status.message());
}

class DataCopyTest : public ::testing::Test {
 protected:
  void SetUp() override { testing::FillData(from_); }

  absl::StatusOr<CopyReport> Copy(const std::string& to,
                                  const Progress& progress = {}) {
    return CopyBetween(from_, to, progress);
  }
  static absl::StatusOr<CopyReport> CopyBetween(const std::string& from,
                                                const std::string& to,
                                                const Progress& progress = {}) {
    FileSystem& files = PosixFileSystem();
    TACTUS_ASSIGN_OR_RETURN(const auto source,
                            OpenDirectoryToCopy(files, from));
    TACTUS_ASSIGN_OR_RETURN(const auto target, MakeDirectoryToCopy(files, to));
    return CopyData(files, source->place(), target->place(), progress);
  }
  // Ends a copy to `to` when it has copied the blobs.
  void Interrupt(const std::string& to) {
    const std::string path = from_ + "/uploads/2";
    std::filesystem::rename(path, path + ".away");
    EXPECT_FALSE(Copy(to).ok());
    std::filesystem::rename(path + ".away", path);
  }

  // Without an open server.
  static std::unique_ptr<Catalog> CatalogOf(const std::string& folder) {
    return *OpenSqliteCatalog(CatalogPath(folder));
  }

  static void ExpectSameRecords(const std::string& a, const std::string& b) {
    const auto left = CatalogOf(a);
    const auto right = CatalogOf(b);
    for (const auto& [table, name] : kTables) {
      std::map<std::string, std::string> records[2];
      for (const Catalog* catalog : {left.get(), right.get()}) {
        for (const CatalogEntry& entry : Scan(*catalog, {}, table)) {
          if (!IsCopied(table, entry.key)) continue;
          records[catalog == right.get()][entry.key] = entry.value;
        }
      }
      EXPECT_EQ(records[0], records[1]) << name;
    }
  }
  void ExpectCopied(const std::string& to) const {
    ExpectSameRecords(from_, to);
    EXPECT_TRUE(DataFilesBelow(to) == FilledFiles());
  }

  // A catalogue with a part of the records is one that servers refuse.
  void ExpectNoPart(const std::string& to) const {
    if (!std::filesystem::exists(CatalogPath(to))) return;
    const auto catalog = CatalogOf(to);
    if (!*HasCopiedRecords(*catalog)) return;
    if (!RefuseUnfinishedCopy(*catalog, to).ok()) return;
    ExpectCopied(to);
  }

  static std::string BlobIn(const std::string& folder,
                            const std::string& bytes) {
    return BlobPath(folder + "/blobs", Sha256Hex(bytes));
  }

  ScratchDir folder_;
  const std::string from_ = folder_ / "from";
  const std::string to_ = folder_ / "to";
};

TEST_F(DataCopyTest, CopiesWhatRecordsNameAndChangesNothing) {
  const auto before = FilesBelow(from_);
  double done = 0;
  const auto report =
      Copy(to_, Progress([&](auto, double fraction) { done += fraction; }));
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_TRUE(FilesBelow(from_) == before);
  ExpectCopied(to_);
  EXPECT_FALSE(report->resumed);
  EXPECT_EQ(report->blobs, testing::kFilledTrials + 2);
  EXPECT_EQ(report->unnamed_blobs, 1);
  EXPECT_EQ(report->uploads, 1);
  EXPECT_EQ(report->jobs, 1);
  // Blobs, records, and the check.
  EXPECT_NEAR(done, 3, 0.1);
  // What is of the place stays there.
  const auto catalog = CatalogOf(to_);
  EXPECT_EQ(Get(*catalog, "replicas", Table::kNumbers), std::nullopt);
  EXPECT_EQ(Get(*catalog, "datasets", Table::kLeases), std::nullopt);
  EXPECT_NE(*DirectoryIdOf(*catalog), *DirectoryIdOf(*CatalogOf(from_)));
  EXPECT_FALSE(std::filesystem::exists(to_ + "/contacts"));
  EXPECT_FALSE(std::filesystem::exists(to_ + "/lost+found"));
}

TEST_F(DataCopyTest, AServerStartsWithTheCopy) {
  ASSERT_TRUE(Copy(to_).ok());
  const auto data = DataDirectory::Open(PosixFileSystem(), to_);
  ASSERT_TRUE(data.ok()) << data.status();
  EXPECT_FALSE((*data)->catalog_is_older());
  EXPECT_TRUE((*data)->catalog().Check().ok());
}

TEST_F(DataCopyTest, ThereAndBackAreTheSameRecords) {
  ASSERT_TRUE(Copy(to_).ok());
  const auto back = CopyBetween(to_, folder_ / "back");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->unnamed_blobs, 0);
  ExpectCopied(folder_ / "back");
}

TEST_F(DataCopyTest, ADamagedBlobIsNamedAndMendedByTheNextRun) {
  const std::string first = BlobIn(from_, testing::FilledTrial(1));
  const std::string second = BlobIn(from_, testing::FilledTrial(3));
  WriteBytes(first, "damaged");
  WriteBytes(second, "damaged, too");
  const absl::Status refused = Copy(to_).status();
  EXPECT_EQ(ReasonOf(refused), "DATA_LOST");
  for (const int trial : {1, 3}) {
    EXPECT_THAT(Said(refused),
                HasSubstr(Sha256Hex(testing::FilledTrial(trial))));
  }
  WriteBytes(first, testing::FilledTrial(1));
  WriteBytes(second, testing::FilledTrial(3));
  const auto report = Copy(to_);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_TRUE(report->resumed);
  ExpectCopied(to_);
}

TEST_F(DataCopyTest, AMissingBlobIsNamedBeforeAnythingIsWritten) {
  std::filesystem::remove(BlobIn(from_, testing::FilledModel()));
  const absl::Status refused = Copy(to_).status();
  EXPECT_EQ(ReasonOf(refused), "DATA_LOST");
  EXPECT_THAT(Said(refused), HasSubstr(Sha256Hex(testing::FilledModel())));
  EXPECT_EQ(DataFilesBelow(to_).size(), 0u);
}

// Written half by a copy whose disk lied.
TEST_F(DataCopyTest, ADamagedBlobOfTheTargetIsWrittenAgain) {
  Interrupt(to_);
  WriteBytes(BlobIn(to_, testing::FilledTrial(2)), "trial");
  const auto report = Copy(to_);
  ASSERT_TRUE(report.ok()) << report.status();
  ExpectCopied(to_);
}

TEST_F(DataCopyTest, ADamagedUploadIsNamed) {
  WriteBytes(from_ + "/uploads/2", "short");
  absl::Status refused = Copy(to_).status();
  EXPECT_EQ(ReasonOf(refused), "DATA_LOST");
  EXPECT_THAT(Said(refused), HasSubstr("uploads/2"));
  std::string bytes = testing::FilledUpload();
  bytes[1'099'999] = 'x';
  WriteBytes(from_ + "/uploads/2", bytes);
  refused = Copy(to_).status();
  EXPECT_EQ(ReasonOf(refused), "DATA_LOST");
}

TEST_F(DataCopyTest, ATargetThatHoldsSomethingElseIsRefused) {
  // A directory with other data.
  testing::FillData(folder_ / "other");
  const auto before = FilesBelow(folder_ / "other");
  absl::Status refused = Copy(folder_ / "other").status();
  EXPECT_EQ(ReasonOf(refused), "IO");
  EXPECT_THAT(Said(refused), HasSubstr("its catalogue has records"));
  EXPECT_TRUE(FilesBelow(folder_ / "other") == before);
  // A copy of something else.
  Interrupt(to_);
  refused = CopyBetween(folder_ / "other", to_).status();
  EXPECT_THAT(Said(refused), HasSubstr("a copy of other data"));
  // Blobs alone.
  { ASSERT_TRUE(MakeDirectoryToCopy(PosixFileSystem(), folder_ / "b").ok()); }
  const std::string orphan = BlobIn(folder_ / "b", "orphan");
  std::filesystem::create_directories(
      std::filesystem::path(orphan).parent_path());
  WriteBytes(orphan, "orphan");
  EXPECT_THAT(Said(Copy(folder_ / "b").status()), HasSubstr("holds 1 blobs"));
  // This copy, which is finished.
  ASSERT_TRUE(Copy(to_).ok());
  EXPECT_THAT(Said(Copy(to_).status()), HasSubstr("was finished before"));
}

TEST_F(DataCopyTest, AnEmptyDirectoryOfAServerIsATarget) {
  { ASSERT_TRUE(DataDirectory::Open(PosixFileSystem(), to_).ok()); }
  const auto report = Copy(to_);
  ASSERT_TRUE(report.ok()) << report.status();
  ExpectCopied(to_);
  EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), to_).ok());
}

TEST_F(DataCopyTest, AServerAtEitherSideIsRefused) {
  for (const std::string& folder : {from_, to_}) {
    const auto server = DataDirectory::Open(PosixFileSystem(), folder);
    ASSERT_TRUE(server.ok()) << server.status();
    const absl::Status refused = Copy(to_).status();
    EXPECT_THAT(Said(refused), HasSubstr("another process uses"));
  }
}

TEST_F(DataCopyTest, AServerRefusesAnUnfinishedCopy) {
  Interrupt(to_);
  const absl::Status refused =
      DataDirectory::Open(PosixFileSystem(), to_).status();
  EXPECT_EQ(ReasonOf(refused), "IO");
  EXPECT_THAT(Said(refused), HasSubstr("is not finished"));
  // Nor is it a source.
  EXPECT_THAT(Said(CopyBetween(to_, folder_ / "third").status()),
              HasSubstr("is not finished"));
  ASSERT_TRUE(Copy(to_).ok());
  EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), to_).ok());
}

TEST_F(DataCopyTest, WhatIsNoSourceIsRefused) {
  EXPECT_THAT(Said(CopyBetween(folder_ / "none", to_).status()),
              HasSubstr("does not exist"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  std::filesystem::remove(CatalogPath(from_));
  EXPECT_EQ(ReasonOf(Copy(to_).status()), "DATA_LOST");
}

// The server runs again between two runs of the copy.
TEST_F(DataCopyTest, FollowsASourceThatChangedSince) {
  std::filesystem::remove(BlobIn(from_, testing::FilledTrial(4)));
  const std::string gone = Sha256Hex(testing::FilledTrial(4));
  {
    const auto catalog = CatalogOf(from_);
    ASSERT_TRUE(catalog
                    ->Change([&](Transaction& change) {
                      return change.Erase(Table::kTrials, gone);
                    })
                    .ok());
    ASSERT_TRUE(Put(*catalog, "zzz", "1", Table::kNumbers).ok());
  }
  ASSERT_TRUE(Copy(to_).ok());
  const auto reopened = [&](const std::string& folder) {
    const auto catalog = CatalogOf(folder);
    EXPECT_TRUE(catalog
                    ->Change([&](Transaction& change) {
                      return PutCopyMark(
                          change, {.source = *DirectoryIdOf(*CatalogOf(from_)),
                                   .run = "before"});
                    })
                    .ok());
  };
  reopened(to_);
  WriteBytes(to_ + "/copying", *DirectoryIdOf(*CatalogOf(from_)));
  WriteBytes(to_ + "/uploads/9", "of an upload that has ended");
  {
    const auto catalog = CatalogOf(from_);
    ASSERT_TRUE(catalog
                    ->Change([&](Transaction& change) -> absl::Status {
                      for (int i = 0; i < 100; ++i) {
                        TACTUS_RETURN_IF_ERROR(
                            change.Erase(Table::kAudit, NumberKey(i)));
                      }
                      TACTUS_RETURN_IF_ERROR(
                          change.Erase(Table::kNumbers, "zzz"));
                      return change.Erase(Table::kTrials,
                                          Sha256Hex(testing::FilledTrial(0)));
                    })
                    .ok());
    ASSERT_TRUE(Put(*catalog, NumberKey(120), "other", Table::kAudit).ok());
  }
  const auto report = Copy(to_);
  ASSERT_TRUE(report.ok()) << report.status();
  ExpectSameRecords(from_, to_);
  EXPECT_FALSE(std::filesystem::exists(to_ + "/uploads/9"));
}

// Two people begin the same copy: one of them ends, and the other one must not
// write to what a server may have changed by then.
TEST_F(DataCopyTest, OneRunIsStoppedByTheNextOne) {
  FileSystem& files = PosixFileSystem();
  const auto source = OpenDirectoryToCopy(files, from_);
  const auto target = MakeDirectoryToCopy(files, to_);
  ASSERT_TRUE(target.ok()) << target.status();
  bool nested = false;
  const auto report = CopyData(
      files, (*source)->place(), (*target)->place(),
      Progress([&](absl::string_view phase, double) {
        if (phase != "copying records" || nested) return;
        nested = true;
        EXPECT_TRUE(
            CopyData(files, (*source)->place(), (*target)->place()).ok());
        EXPECT_TRUE(Put(*CatalogOf(to_), "d", "changed", Table::kAliases).ok());
      }));
  EXPECT_TRUE(nested);
  EXPECT_TRUE(absl::IsAborted(report.status())) << report.status();
  EXPECT_EQ(Get(*CatalogOf(to_), "d", Table::kAliases), "changed");
}

// Before its records are copied, so that both sides are equal but the new ones
// may name blobs that were not copied; and after that.
TEST_F(DataCopyTest, ASourceThatChangesMeanwhileIsSeen) {
  for (const std::string when : {"copying blobs", "copying records"}) {
    bool changed = false;
    const auto report = Copy(
        to_, Progress([&](absl::string_view phase, double) {
          if (phase != when || changed) return;
          changed = true;
          EXPECT_TRUE(Put(*CatalogOf(from_), "d", when, Table::kDatasets).ok());
        }));
    EXPECT_TRUE(changed);
    EXPECT_THAT(Said(report.status()), HasSubstr("changed meanwhile")) << when;
    EXPECT_FALSE(DataDirectory::Open(PosixFileSystem(), to_).ok());
  }
  EXPECT_TRUE(Copy(to_).ok());
}

// A crash of the machine at every operation that changes the target's disk.
TEST_F(DataCopyTest, GoesOnAfterACrashAtEachOperation) {
  const auto run = [&](CrashFileSystem& files, const std::string& to,
                       const std::string& vfs) -> absl::StatusOr<CopyReport> {
    TACTUS_ASSIGN_OR_RETURN(const auto source,
                            OpenDirectoryToCopy(PosixFileSystem(), from_));
    TACTUS_ASSIGN_OR_RETURN(const auto target,
                            MakeDirectoryToCopy(files, to, vfs));
    return CopyData(files, source->place(), target->place());
  };
  int resumed = 0;
  const int step = testing::StepOfInterruptions();
  for (int k = 1;; k += step) {
    SCOPED_TRACE(k);
    const auto loss = CrashFileSystem::kLosses[k % 4];
    const std::string to = folder_ / std::to_string(k);
    CrashFileSystem files;
    const CrashVfs vfs(&files);
    files.StopAt(k);
    const absl::Status stopped = run(files, to, vfs.name()).status();
    if (!files.failed()) {
      EXPECT_TRUE(stopped.ok()) << stopped;
      EXPECT_GT(k, 100);
      break;
    }
    files.Lose(loss);
    files.Heal();
    ExpectNoPart(to);
    const auto report = run(files, to, vfs.name());
    if (report.ok()) {
      resumed += report->resumed ? 1 : 0;
    } else {
      // All was done but the last removals.
      EXPECT_THAT(Said(report.status()), HasSubstr("was finished before"));
    }
    ExpectCopied(to);
    ASSERT_FALSE(HasFailure());
    std::filesystem::remove_all(to);
  }
  EXPECT_GT(resumed * step, 70);
}

}  // namespace
}  // namespace tactus::internal
