// File: copy_records.h
//
// The records of a catalogue, for a copy: which belong to it, how they are
// copied, and what both sides must agree in.
//
//   TACTUS_RETURN_IF_ERROR(CopyRecords(from, to, mark, [](int64_t) {}));
//   TACTUS_ASSIGN_OR_RETURN(const RecordsDigest digest, DigestRecords(to));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"
#include "core/store/copy_mark.h"

namespace tactus::internal {

// False for records of the place and of its processes: the directory's
// identity, replicas and their numbers, leases, signs of life.
bool IsCopied(Table table, absl::string_view key);

absl::StatusOr<bool> HasCopiedRecords(const Catalog& catalog);

// Makes the records of `to` those of `from`: writes what differs, and erases
// what `from` does not have. `on_copied` takes how many more records are done.
// ABORTED if the mark of `to` is another one.
absl::Status CopyRecords(const Catalog& from, Catalog& to, const CopyMark& mark,
                         absl::FunctionRef<void(int64_t)> on_copied);

struct RecordsDigest {
  int64_t records = 0;
  // SHA-256 of all tables, keys and values, in their order.
  std::string sha256;
};
absl::StatusOr<RecordsDigest> DigestRecords(const Catalog& catalog);

}  // namespace tactus::internal
