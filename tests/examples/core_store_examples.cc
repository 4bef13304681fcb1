// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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
#include "core/store/blob_cache.h"
#include "core/store/blob_store.h"
#include "core/store/catalog.h"
#include "core/store/copy_mark.h"
#include "core/store/copy_records.h"
#include "core/store/data_check.h"
#include "core/store/data_copy.h"
#include "core/store/data_directory.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_lock.h"
#include "core/store/directory_to_copy.h"
#include "core/store/disk_reserve.h"
#include "core/store/disk_use.h"
#include "core/store/file_system.h"
#include "core/store/lost_and_found.h"
#include "core/store/named_data.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "core/train/train_spec.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::examples {

static void Crc32cExample(const std::vector<std::string>& chunks) {
#include "core/base/crc32c.h.inc"
}

static void StatusProtoExample(v1::Operation& operation,
                               const absl::Status& status) {
#include "core/base/status_proto.h.inc"
}

static absl::Status TrainSpecExample(const v1::TrainSpec& spec) {
#include "core/train/train_spec.h.inc"
  return absl::OkStatus();
}

static absl::Status FileSystemExample(const std::string& bytes) {
#include "core/store/file_system.h.inc"
  return absl::OkStatus();
}

absl::StatusOr<std::string> ReadFromAfar(const std::string& sha256,
                                         int64_t limit);

static absl::StatusOr<std::string> BlobCacheExample(FileSystem& files,
                                                    const std::string& sha256,
                                                    int64_t limit) {
#include "core/store/blob_cache.h.inc"
  return bytes;
}

static absl::Status BlobStoreExample(FileSystem& files,
                                     const std::string& record) {
#include "core/store/blob_store.h.inc"
  return absl::OkStatus();
}

static absl::Status CatalogExample(const std::unique_ptr<Catalog>& catalog,
                                   const std::string& bytes) {
#include "core/store/catalog.h.inc"
  return absl::OkStatus();
}

static absl::Status SqliteCatalogExample() {
#include "core/store/sqlite_catalog.h.inc"
  return absl::OkStatus();
}

absl::Status NoSuch(const char* name);
absl::Status Delete();

static absl::Status RecordsExample(const Transaction& look) {
#include "core/store/records.h.inc"
  return absl::OkStatus();
}

static absl::Status DataDirectoryExample() {
#include "core/store/data_directory.h.inc"
  return absl::OkStatus();
}

static absl::Status NumbersExample(const Transaction& look, Transaction& change,
                                   const std::string& entry) {
#include "core/store/numbers.h.inc"
  return absl::OkStatus();
}

static absl::Status AppendAuditExample(Transaction& change) {
#include "core/store/audit.h.inc"
  return absl::OkStatus();
}

static absl::Status AbandonedUploadsExample(Transaction& change,
                                            int64_t now_ms) {
#include "core/store/abandoned_uploads.h.inc"
  return absl::OkStatus();
}

static absl::Status DirectoryLockExample() {
#include "core/store/directory_lock.h.inc"
  return absl::OkStatus();
}

static void DiskUseExample() {
#include "core/store/disk_use.h.inc"
}

void Print(const CheckResult& result);

static void DataCheckExample(int64_t now_ms) {
#include "core/store/data_check.h.inc"
}

void Print(const std::string& text);

static void TablesExample() {
#include "core/store/tables.h.inc"
}

static absl::Status DiskReserveExample(FileSystem& files) {
#include "core/store/disk_reserve.h.inc"
}

static absl::Status DirectoryIdentityExample(FileSystem& files,
                                             const std::string& folder,
                                             const std::string& path) {
#include "core/store/directory_identity.h.inc"
  return absl::OkStatus();
}

static absl::Status LostAndFoundExample(FileSystem& files) {
#include "core/store/lost_and_found.h.inc"
  return absl::OkStatus();
}

static absl::Status AcceptCatalogExample(FileSystem& files) {
#include "core/store/accept_catalog.h.inc"
  return absl::OkStatus();
}

static absl::Status NamedDataExample(const CatalogEntry& entry,
                                     const std::string& sha256) {
#include "core/store/named_data.h.inc"
  return absl::OkStatus();
}

static absl::Status CopyMarkExample(Transaction& change, const std::string& id,
                                    const std::string& run) {
#include "core/store/copy_mark.h.inc"
  return absl::OkStatus();
}

static absl::Status CopyRecordsExample(const Catalog& from, Catalog& to,
                                       const CopyMark& mark) {
#include "core/store/copy_records.h.inc"
  return absl::OkStatus();
}

static absl::Status DataCopyExample(FileSystem& files, Catalog* shared,
                                    const Progress& progress) {
#include "core/store/data_copy.h.inc"
  return absl::OkStatus();
}

static absl::Status DirectoryToCopyExample(FileSystem& files) {
#include "core/store/directory_to_copy.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
