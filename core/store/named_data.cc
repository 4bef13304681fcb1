#include "core/store/named_data.h"

#include <utility>

#include "absl/strings/str_split.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal {
namespace {

using v1::Operation;

// Logs of jobs have up to a megabyte.
constexpr int kEntriesPerLook = 64;

bool HasOperationEnded(const Operation& operation) {
  return operation.state() == Operation::STATE_SUCCEEDED ||
         operation.state() == Operation::STATE_FAILED ||
         operation.state() == Operation::STATE_CANCELLED;
}

}  // namespace

absl::Status NamedData::Take(Table table, const CatalogEntry& entry) {
  switch (table) {
    case Table::kTrials:
      blobs.insert(entry.key);
      return absl::OkStatus();
    case Table::kDatasetVersions: {
      TACTUS_ASSIGN_OR_RETURN(
          const auto version,
          ParseRecord<v1::DatasetVersion>(entry.key, entry.value));
      blobs.insert(version.sha256());
      manifests.insert(version.sha256());
      return absl::OkStatus();
    }
    case Table::kModelVersions: {
      TACTUS_ASSIGN_OR_RETURN(const auto version, ParseRecord<v1::ModelVersion>(
                                                      entry.key, entry.value));
      if (!version.blob_sha256().empty()) blobs.insert(version.blob_sha256());
      return absl::OkStatus();
    }
    case Table::kUploads: {
      TACTUS_ASSIGN_OR_RETURN(
          auto upload, ParseRecord<v1::StoredUpload>(entry.key, entry.value));
      uploads.push_back(std::move(upload));
      return absl::OkStatus();
    }
    case Table::kOperations: {
      TACTUS_ASSIGN_OR_RETURN(const auto operation,
                              ParseRecord<Operation>(entry.key, entry.value));
      const std::pair<std::string, std::string> parts =
          absl::StrSplit(operation.name(), absl::MaxSplits('/', 1));
      if (!HasOperationEnded(operation)) live_jobs.insert(parts.second);
      return absl::OkStatus();
    }
    default:
      return absl::OkStatus();
  }
}

absl::Status VisitEntries(
    const Catalog& catalog, Table table,
    absl::FunctionRef<absl::Status(const CatalogEntry&)> visit) {
  ScanOptions options = {.limit = kEntriesPerLook};
  while (true) {
    std::vector<CatalogEntry> entries;
    TACTUS_RETURN_IF_ERROR(
        catalog.Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(entries, look.Scan(table, options));
          return absl::OkStatus();
        }));
    for (const CatalogEntry& entry : entries) {
      TACTUS_RETURN_IF_ERROR(visit(entry));
    }
    if (static_cast<int>(entries.size()) < kEntriesPerLook) {
      return absl::OkStatus();
    }
    options.after = entries.back().key;
  }
}

}  // namespace tactus::internal
