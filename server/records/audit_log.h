// File: audit_log.h
//
// The audit log: who changed what, when and from where. An entry is written in
// the transaction of the change that it records, so neither exists without the
// other.
//
//   TACTUS_RETURN_IF_ERROR(Audit(change, caller, now, "create", name));
//   auto page = ListAudit(catalog, 100, "", {.resource_prefix = "models/"});
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"
#include "core/store/numbers.h"
#include "server/records/caller.h"
#include "server/records/paging.h"
#include "tactus/v1/admin.pb.h"

namespace tactus::internal::server {

// Appends an entry: `verb` was done to `name`, for `reason` if one was given.
absl::Status Audit(Transaction& change, const Caller& caller, int64_t now_ms,
                   absl::string_view verb, absl::string_view name,
                   absl::string_view reason = "");

// Which entries ListAudit returns; empty fields accept all.
struct AuditFilter {
  std::string resource_prefix = {};
  std::string caller = {};
};

// The newest first.
absl::StatusOr<Page<v1::AuditEntry>> ListAudit(const Catalog& catalog,
                                               int page_size,
                                               absl::string_view page_token,
                                               const AuditFilter& filter);

}  // namespace tactus::internal::server
