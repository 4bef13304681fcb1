#include "core/store/abandoned_uploads.h"

#include <algorithm>

#include "absl/strings/numbers.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/store/audit.h"
#include "core/store/numbers.h"
#include "core/store/records.h"

namespace tactus::internal {
namespace {

// As the collection of uploads, and in Table::kNumbers.
constexpr char kUploads[] = "uploads";

}  // namespace

bool IsAbandoned(const v1::StoredUpload& upload, int64_t now_ms) {
  const int64_t last =
      std::max(upload.create_time_ms(), upload.write_time_ms());
  return upload.dataset_version().empty() &&
         now_ms - last >= limits::kAbandonedUploadMs;
}

absl::StatusOr<std::vector<v1::StoredUpload>> AbandonedUploads(
    const Transaction& look, int64_t now_ms) {
  TACTUS_ASSIGN_OR_RETURN(
      auto uploads, ScanRecords<v1::StoredUpload>(look, Table::kUploads, {}));
  std::erase_if(uploads, [&](const v1::StoredUpload& upload) {
    return !IsAbandoned(upload, now_ms);
  });
  return uploads;
}

std::string UploadId(const v1::StoredUpload& upload) {
  return upload.name().substr(std::min(sizeof kUploads, upload.name().size()));
}

std::string UploadFile(const v1::StoredUpload& upload) {
  return upload.copy() == 0
             ? UploadId(upload)
             : absl::StrCat(UploadId(upload), "-", upload.copy());
}

absl::StatusOr<uint64_t> NextUpload(const Transaction& look) {
  return NextNumber(look, Table::kUploads, kUploads);
}

absl::Status RemoveUpload(Transaction& change, const v1::StoredUpload& upload,
                          absl::string_view caller, int64_t now_ms) {
  uint64_t number = 0;
  if (!absl::SimpleAtoi(UploadId(upload), &number)) {
    return DataLost(upload.name(), "the upload has no number");
  }
  TACTUS_RETURN_IF_ERROR(KeepNumber(change, Table::kUploads, kUploads));
  TACTUS_RETURN_IF_ERROR(change.Erase(Table::kUploads, NumberKey(number)));
  v1::AuditEntry entry;
  entry.set_time_ms(now_ms);
  entry.set_caller(std::string(caller));
  entry.set_verb("remove");
  entry.set_resource(upload.name());
  return AppendAudit(change, entry);
}

}  // namespace tactus::internal
