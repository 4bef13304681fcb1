// File: catalog.h
//
// Catalog: small records in ordered tables, changed in transactions. It holds
// what the server must not forget: datasets, uploads, operations, model
// versions, aliases. SqliteCatalog implements it; a server of several machines
// may have another one.
//
//   TACTUS_RETURN_IF_ERROR(
//       catalog->Change([&](Transaction& change) -> absl::Status {
//         TACTUS_ASSIGN_OR_RETURN(auto old,
//                                 change.Get(Table::kAliases, "default"));
//         return change.Put(Table::kAliases, "default", bytes);
//       }));
//
// Change is all or nothing: if the function or the commit fails, the catalog is
// as it was. When Change returns OK, the change is on disk.
//
// Thread-safe; the functions run one after another, so they must be short.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// Numbers are stored: they never change.
enum class Table {
  kDatasets = 1,
  kDatasetVersions = 2,
  kTrials = 3,
  kUploads = 4,
  kOperations = 5,
  kLearningPoints = 6,
  kModelVersions = 7,
  kAliases = 8,
  kAliasChanges = 9,
  kRequests = 10,
  kAudit = 11,
  // The largest number that was given under a name.
  kNumbers = 12,
  // Logs of jobs that have ended.
  kJobLogs = 13,
  // Which data directory the catalogue belongs to.
  kDirectory = 14,
  // The servers and workers that share the catalogue.
  kReplicas = 15,
  // Locks that they hold.
  kLeases = 16,
  // That they live: a number of each, which grows. A change of these alone is
  // no news.
  kBeats = 17,
};

struct CatalogEntry {
  std::string key;
  std::string value;
};

// Which entries Scan returns.
struct ScanOptions {
  // Only keys that begin with this.
  std::string prefix = {};
  // Only keys behind this one, in the order of the scan; empty: from the first.
  std::string after = {};
  int limit = 1'000'000'000;
  // From the largest key to the smallest.
  bool backwards = false;
};

// Errors: IO, STORAGE_FULL, DATA_LOST.
class Transaction {
 public:
  virtual ~Transaction() = default;
  virtual absl::StatusOr<std::optional<std::string>> Get(
      Table table, absl::string_view key) const = 0;
  // In the order of the keys' bytes.
  virtual absl::StatusOr<std::vector<CatalogEntry>> Scan(
      Table table, const ScanOptions& options) const = 0;
  // Replaces the value of a key that exists.
  virtual absl::Status Put(Table table, absl::string_view key,
                           absl::string_view value) = 0;
  // OK if the key does not exist.
  virtual absl::Status Erase(Table table, absl::string_view key) = 0;
};

class Catalog {
 public:
  virtual ~Catalog() = default;
  virtual absl::Status Change(
      absl::FunctionRef<absl::Status(Transaction&)> change) = 0;
  // As Change, but `look` must not write.
  virtual absl::Status Look(
      absl::FunctionRef<absl::Status(const Transaction&)> look) const = 0;
  // Reads every page, and checks the structure and that the records are those
  // that were written: none was removed or exchanged by another program.
  // DATA_LOST with what is wrong.
  virtual absl::Status Check() const = 0;
};

}  // namespace tactus::internal
