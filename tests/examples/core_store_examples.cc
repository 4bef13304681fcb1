// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <memory>
#include <string>
#include <vector>

#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/status_proto.h"
#include "core/store/abandoned_uploads.h"
#include "core/store/accept_catalog.h"
#include "core/store/audit.h"
#include "core/store/blob_store.h"
#include "core/store/catalog.h"
#include "core/store/data_check.h"
#include "core/store/data_directory.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_lock.h"
#include "core/store/disk_reserve.h"
#include "core/store/disk_use.h"
#include "core/store/file_system.h"
#include "core/store/lost_and_found.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "core/train/train_spec.h"
#include "tactus/v1/training.pb.h"

namespace tactus::examples {

void Crc32cExample(const std::vector<std::string>& chunks) {
  uint32_t crc = 0;
  for (const auto& chunk : chunks) crc = ExtendCrc32c(crc, chunk);
}

void StatusProtoExample(v1::Operation& operation, const absl::Status& status) {
  *operation.mutable_error() = ToStatusProto(status);
  const absl::Status same = FromStatusProto(operation.error());
}

absl::Status TrainSpecExample(const v1::TrainSpec& spec) {
  TACTUS_RETURN_IF_ERROR(CheckOptions(spec));
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, OptionsOf(spec, "tuned"));
  return absl::OkStatus();
}

absl::Status FileSystemExample(const std::string& bytes) {
  FileSystem& files = PosixFileSystem();
  TACTUS_ASSIGN_OR_RETURN(auto file, files.Append("blobs/draft"));
  TACTUS_RETURN_IF_ERROR(file->Append(bytes));
  TACTUS_RETURN_IF_ERROR(file->Sync());
  return absl::OkStatus();
}

absl::Status BlobStoreExample(FileSystem& files, const std::string& record) {
  TACTUS_ASSIGN_OR_RETURN(auto blobs, BlobStore::Open(files, "blobs"));
  BlobStore::Batch batch = blobs->NewBatch();
  TACTUS_ASSIGN_OR_RETURN(std::string sha256, batch.Add(record));
  TACTUS_RETURN_IF_ERROR(batch.Commit());  // now on disk
  return absl::OkStatus();
}

absl::Status CatalogExample(const std::unique_ptr<Catalog>& catalog,
                            const std::string& bytes) {
  TACTUS_RETURN_IF_ERROR(
      catalog->Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(auto old,
                                change.Get(Table::kAliases, "default"));
        return change.Put(Table::kAliases, "default", bytes);
      }));
  return absl::OkStatus();
}

absl::Status SqliteCatalogExample() {
  TACTUS_ASSIGN_OR_RETURN(auto catalog, OpenSqliteCatalog("catalog.db"));
  return absl::OkStatus();
}

absl::Status NoSuch(const char* name);

absl::Status RecordsExample(const Transaction& look) {
  TACTUS_ASSIGN_OR_RETURN(auto dataset,
                          GetRecord<v1::Dataset>(look, Table::kDatasets, "d"));
  if (!dataset.has_value()) return NoSuch("d");
  return absl::OkStatus();
}

absl::Status DataDirectoryExample() {
  TACTUS_ASSIGN_OR_RETURN(auto data,
                          DataDirectory::Open(PosixFileSystem(), "/data"));
  BlobStore& blobs = data->blobs();
  return absl::OkStatus();
}

absl::Status NumbersExample(const Transaction& look, Transaction& change,
                            const std::string& entry) {
  TACTUS_ASSIGN_OR_RETURN(uint64_t number, NextNumber(look, Table::kAudit));
  TACTUS_RETURN_IF_ERROR(change.Put(Table::kAudit, NumberKey(number), entry));
  return absl::OkStatus();
}

absl::Status AppendAuditExample(Transaction& change) {
  v1::AuditEntry entry;
  entry.set_verb("remove");
  TACTUS_RETURN_IF_ERROR(AppendAudit(change, entry));
  return absl::OkStatus();
}

absl::Status AbandonedUploadsExample(Transaction& change, int64_t now_ms) {
  TACTUS_ASSIGN_OR_RETURN(auto uploads, AbandonedUploads(change, now_ms));
  for (const v1::StoredUpload& upload : uploads) {
    TACTUS_RETURN_IF_ERROR(RemoveUpload(change, upload, "tactusd", now_ms));
  }
  return absl::OkStatus();
}

absl::Status DirectoryLockExample() {
  TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take("/data"));
  return absl::OkStatus();
}

void DiskUseExample() {
  const v1::DataUse use = MeasureData("/data");
  use.blob_bytes();
}

void Print(const CheckResult& result);

void DataCheckExample(int64_t now_ms) {
  for (const CheckResult& result :
       CheckData(PosixFileSystem(), "/data", {.now_ms = now_ms})) {
    Print(result);
  }
}

void Print(const std::string& text);

void TablesExample() {
  for (const auto& [table, name] : kTables) Print(name);
}

absl::Status Delete();

absl::Status DiskReserveExample(FileSystem& files) {
  DiskReserve reserve(files, "/data/reserve", 32 << 20);
  reserve.Renew();
  TACTUS_RETURN_IF_ERROR(reserve.Check());  // before writing much
  return reserve.With([&] { return Delete(); });
}

absl::Status DirectoryIdentityExample(FileSystem& files,
                                      const std::string& folder,
                                      const std::string& path) {
  TACTUS_RETURN_IF_ERROR(CheckCatalogFile(files, folder));
  TACTUS_ASSIGN_OR_RETURN(auto catalog, OpenSqliteCatalog(path));
  TACTUS_RETURN_IF_ERROR(CheckCatalogBelongs(files, folder, *catalog));
  TACTUS_RETURN_IF_ERROR(MarkDirectory(files, folder, *catalog));
  return absl::OkStatus();
}

absl::Status LostAndFoundExample(FileSystem& files) {
  LostAndFound lost(files, "/data");
  TACTUS_RETURN_IF_ERROR(lost.Take("blobs/ab/abcd"));
  Print(lost.folder());  // "/data/lost+found/3", with "blobs/ab/abcd" in it
  return absl::OkStatus();
}

absl::Status AcceptCatalogExample(FileSystem& files) {
  TACTUS_ASSIGN_OR_RETURN(auto done, AcceptCatalog(files, "/data"));
  Print(done);  // "there was none; a new one begins without records"
  return absl::OkStatus();
}

}  // namespace tactus::examples
