// File: audit.h
//
// Entries of the audit log, which is a table of the catalogue.
//
//   v1::AuditEntry entry;
//   entry.set_verb("remove");
//   TACTUS_RETURN_IF_ERROR(AppendAudit(change, entry));
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/status.h"
#include "core/store/catalog.h"
#include "tactus/v1/admin.pb.h"

namespace tactus::internal {

// Appends `entry` in the transaction of the change that it records.
absl::Status AppendAudit(Transaction& change, const v1::AuditEntry& entry);

}  // namespace tactus::internal
