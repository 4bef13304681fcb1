#include "core/store/copy_records.h"

#include <map>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/store/named_data.h"
#include "core/store/tables.h"

namespace tactus::internal {
namespace {

constexpr int kRecordsPerChange = 64;

// Those of the place and its processes are not.
bool IsTableCopied(Table table) {
  return table != Table::kReplicas && table != Table::kLeases &&
         table != Table::kBeats && table != Table::kDirectory;
}

void Frame(absl::string_view bytes, Sha256& sha256) {
  sha256.Add(absl::StrCat(bytes.size(), ":"));
  sha256.Add(bytes);
}

// Makes `entries` the records of the table behind `after` up to `end`.
absl::Status Replace(Transaction& change, Table table, const std::string& after,
                     const std::string& end,
                     const std::vector<CatalogEntry>& entries) {
  std::map<std::string, std::string> there;
  ScanOptions options = {.after = after, .limit = kRecordsPerChange};
  bool more = true;
  while (more) {
    TACTUS_ASSIGN_OR_RETURN(auto page, change.Scan(table, options));
    more = static_cast<int>(page.size()) == kRecordsPerChange;
    for (CatalogEntry& entry : page) {
      options.after = entry.key;
      if (!end.empty() && entry.key > end) {
        more = false;
        break;
      }
      there.emplace(std::move(entry.key), std::move(entry.value));
    }
  }
  for (const CatalogEntry& entry : entries) {
    if (!IsCopied(table, entry.key)) continue;
    const auto found = there.find(entry.key);
    const bool same = found != there.end() && found->second == entry.value;
    if (found != there.end()) there.erase(found);
    if (same) continue;
    TACTUS_RETURN_IF_ERROR(change.Put(table, entry.key, entry.value));
  }
  // An earlier run left them, if the source has changed since.
  for (const auto& [key, value] : there) {
    if (!IsCopied(table, key)) continue;
    TACTUS_RETURN_IF_ERROR(change.Erase(table, key));
  }
  return absl::OkStatus();
}

absl::Status CopyTable(const Catalog& from, Catalog& to, Table table,
                       const CopyMark& mark,
                       absl::FunctionRef<void(int64_t)> on_copied) {
  std::string after;
  bool last = false;
  while (!last) {
    std::vector<CatalogEntry> entries;
    TACTUS_RETURN_IF_ERROR(
        from.Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(
              entries,
              look.Scan(table, {.after = after, .limit = kRecordsPerChange}));
          return absl::OkStatus();
        }));
    last = static_cast<int>(entries.size()) < kRecordsPerChange;
    // The last key of this part; empty: to the end of the table.
    const std::string end = last ? "" : entries.back().key;
    TACTUS_RETURN_IF_ERROR(to.Change([&](Transaction& change) -> absl::Status {
      TACTUS_RETURN_IF_ERROR(CheckCopyMark(change, mark));
      return Replace(change, table, after, end, entries);
    }));
    on_copied(static_cast<int64_t>(entries.size()));
    after = end;
  }
  return absl::OkStatus();
}

}  // namespace

bool IsCopied(Table table, absl::string_view key) {
  // Replicas count the processes of one catalogue.
  return IsTableCopied(table) &&
         !(table == Table::kNumbers && key == "replicas");
}

absl::StatusOr<bool> HasCopiedRecords(const Catalog& catalog) {
  bool found = false;
  for (const auto& named : kTables) {
    const Table table = named.first;
    if (!IsTableCopied(table)) continue;
    TACTUS_RETURN_IF_ERROR(
        catalog.Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(const auto some,
                                  look.Scan(table, {.limit = 2}));
          for (const CatalogEntry& entry : some) {
            found |= IsCopied(table, entry.key);
          }
          return absl::OkStatus();
        }));
  }
  return found;
}

absl::Status CopyRecords(const Catalog& from, Catalog& to, const CopyMark& mark,
                         absl::FunctionRef<void(int64_t)> on_copied) {
  for (const auto& named : kTables) {
    if (!IsTableCopied(named.first)) continue;
    TACTUS_RETURN_IF_ERROR(CopyTable(from, to, named.first, mark, on_copied));
  }
  return absl::OkStatus();
}

absl::StatusOr<RecordsDigest> DigestRecords(const Catalog& catalog) {
  RecordsDigest digest;
  Sha256 sha256;
  for (const auto& named : kTables) {
    const Table table = named.first;
    if (!IsTableCopied(table)) continue;
    TACTUS_RETURN_IF_ERROR(
        VisitEntries(catalog, table, [&](const CatalogEntry& entry) {
          if (!IsCopied(table, entry.key)) return absl::OkStatus();
          ++digest.records;
          Frame(absl::StrCat(static_cast<int>(table)), sha256);
          Frame(entry.key, sha256);
          Frame(entry.value, sha256);
          return absl::OkStatus();
        }));
  }
  digest.sha256 = absl::BytesToHexString(sha256.Finish());
  return digest;
}

}  // namespace tactus::internal
