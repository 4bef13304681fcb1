// File: shared_copy.h
//
// A filled data directory, and an empty catalogue and folder of several servers
// to copy it to.
//
//   class MyTest : public SharedCopyTest {};
//   TEST_F(MyTest, X) { ASSERT_TRUE(CopyIn().ok()); }
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/base/errors.h"
#include "core/postgres/live_replicas.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/copy_records.h"
#include "core/store/data_copy.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_to_copy.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "gtest/gtest.h"
#include "tests/support/catalog_access.h"
#include "tests/support/filled_data.h"
#include "tests/support/postgres_server.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {

inline std::string Message(const absl::Status& status) {
  return std::string(status.message());
}

// A catalogue that is away from a chosen call on.
class FailingCatalog final : public Catalog {
 public:
  explicit FailingCatalog(Catalog* catalog) : catalog_(catalog) {}

  // Fails call number `count`, from 1, and all later ones.
  void StopAt(int count) {
    stop_at_ = count;
    calls_ = 0;
  }
  bool failed() const { return stop_at_ > 0 && calls_ >= stop_at_; }

  absl::Status Change(
      absl::FunctionRef<absl::Status(Transaction&)> change) override {
    TACTUS_RETURN_IF_ERROR(Count());
    return catalog_->Change(change);
  }
  absl::Status Look(
      absl::FunctionRef<absl::Status(const Transaction&)> look) const override {
    TACTUS_RETURN_IF_ERROR(Count());
    return catalog_->Look(look);
  }
  absl::Status Check() const override { return catalog_->Check(); }

 private:
  absl::Status Count() const {
    ++calls_;
    return failed() ? CatalogUnavailable("test", "it is away")
                    : absl::OkStatus();
  }

  Catalog* const catalog_;
  int stop_at_ = 0;
  mutable int calls_ = 0;
};

class SharedCopyTest : public ::testing::Test {
 protected:
  static void TearDownTestSuite() {
    delete server_;
    server_ = nullptr;
  }
  void SetUp() override {
    if (!testing::PostgresServer::IsInstalled()) {
      GTEST_SKIP() << "PostgreSQL is not installed";
    }
    if (server_ == nullptr) server_ = new testing::PostgresServer();
    address_ = server_->NewDatabase();
    auto catalog = OpenPostgresCatalog(address_);
    ASSERT_TRUE(catalog.ok()) << catalog.status();
    shared_ = *std::move(catalog);
    testing::FillData(from_);
  }

  CopyPlace Shared(Catalog* catalog = nullptr) const {
    return {.catalog = catalog != nullptr ? catalog : shared_.get(),
            .folder = blobs_,
            .shared = true,
            .servers = [this] {
              return LiveReplicas(*shared_, std::chrono::milliseconds(500));
            }};
  }
  absl::StatusOr<CopyReport> CopyIn(FileSystem& files,
                                    Catalog* catalog = nullptr) {
    TACTUS_ASSIGN_OR_RETURN(const auto source,
                            OpenDirectoryToCopy(PosixFileSystem(), from_));
    return CopyData(files, source->place(), Shared(catalog));
  }
  absl::StatusOr<CopyReport> CopyIn() { return CopyIn(PosixFileSystem()); }
  absl::StatusOr<CopyReport> CopyOut(const std::string& to) {
    TACTUS_ASSIGN_OR_RETURN(const auto target,
                            MakeDirectoryToCopy(PosixFileSystem(), to));
    return CopyData(PosixFileSystem(), Shared(), target->place());
  }
  // Another empty target.
  void Clear() const {
    ASSERT_TRUE(shared_
                    ->Change([](Transaction& change) -> absl::Status {
                      for (const auto& named : kTables) {
                        TACTUS_ASSIGN_OR_RETURN(const auto entries,
                                                change.Scan(named.first, {}));
                        for (const CatalogEntry& entry : entries) {
                          TACTUS_RETURN_IF_ERROR(
                              change.Erase(named.first, entry.key));
                        }
                      }
                      return absl::OkStatus();
                    })
                    .ok());
    std::filesystem::remove_all(blobs_);
  }
  // As a server, without its signs of life.
  absl::Status Serve() {
    LocalLocks locks;
    return DataDirectory::OpenShared(PosixFileSystem(), blobs_, "1",
                                     shared_.get(), &locks)
        .status();
  }

  // Each byte of each record.
  static std::map<std::string, std::string> Records(const Catalog& catalog) {
    std::map<std::string, std::string> records;
    for (const auto& [table, name] : kTables) {
      for (const CatalogEntry& entry : testing::Scan(catalog, {}, table)) {
        if (!IsCopied(table, entry.key)) continue;
        records[std::string(name) + "/" + entry.key] = entry.value;
      }
    }
    return records;
  }
  static std::map<std::string, std::string> RecordsOf(
      const std::string& folder) {
    return Records(**OpenSqliteCatalog(CatalogPath(folder)));
  }

  static inline testing::PostgresServer* server_ = nullptr;
  ScratchDir folder_;
  std::string address_;
  std::unique_ptr<Catalog> shared_;
  const std::string from_ = folder_ / "from";
  const std::string blobs_ = folder_ / "shared";
};

}  // namespace tactus::internal
