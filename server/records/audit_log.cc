#include "server/records/audit_log.h"

#include <string>

#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/store/audit.h"
#include "core/store/records.h"

namespace tactus::internal::server {
namespace {

// Entries that are read at once, while others wait for the catalogue.
constexpr int kBatch = 1'000;

bool Matches(const AuditFilter& filter, const v1::AuditEntry& entry) {
  return absl::StartsWith(entry.resource(), filter.resource_prefix) &&
         (filter.caller.empty() || entry.caller() == filter.caller);
}

}  // namespace

absl::Status Audit(Transaction& change, const Caller& caller, int64_t now_ms,
                   absl::string_view verb, absl::string_view name,
                   absl::string_view reason) {
  v1::AuditEntry entry;
  entry.set_time_ms(now_ms);
  entry.set_caller(caller.name);
  entry.set_peer(caller.peer);
  entry.set_verb(std::string(verb));
  entry.set_resource(std::string(name));
  entry.set_reason(std::string(reason));
  return AppendAudit(change, entry);
}

absl::StatusOr<Page<v1::AuditEntry>> ListAudit(const Catalog& catalog,
                                               int page_size,
                                               absl::string_view page_token,
                                               const AuditFilter& filter) {
  Page<v1::AuditEntry> page;
  std::string after(page_token);
  std::string last;
  while (true) {
    std::vector<CatalogEntry> batch;
    TACTUS_RETURN_IF_ERROR(
        catalog.Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(
              batch,
              look.Scan(Table::kAudit,
                        {.after = after, .limit = kBatch, .backwards = true}));
          return absl::OkStatus();
        }));
    for (const CatalogEntry& found : batch) {
      TACTUS_ASSIGN_OR_RETURN(
          v1::AuditEntry entry,
          ParseRecord<v1::AuditEntry>(found.key, found.value));
      if (!Matches(filter, entry)) continue;
      if (static_cast<int>(page.items.size()) == page_size) {
        page.next_token = last;
        return page;
      }
      page.items.push_back(std::move(entry));
      last = found.key;
    }
    if (static_cast<int>(batch.size()) < kBatch) return page;
    after = batch.back().key;
  }
}

}  // namespace tactus::internal::server
