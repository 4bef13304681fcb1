// File: audit_log.h
//
// The audit log: who changed what, when and from where. An entry is written in
// the transaction of the change that it records, so neither exists without the
// other.
//
//   TACTUS_RETURN_IF_ERROR(Audit(change, caller, now, "create", name));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"
#include "server/records/caller.h"

namespace tactus::server {

// Appends an entry: `verb` was done to `name`.
absl::Status Audit(Transaction& change, const Caller& caller, int64_t now_ms,
                   absl::string_view verb, absl::string_view name);

// The number behind the largest key of a table whose keys are numbers; from 1.
absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table);

}  // namespace tactus::server
