// File: numbers.h
//
// Numbers that name things in a catalogue: keys that sort by their value, the
// next number of a table, and numbers that stay used when what had them is
// deleted.
//
//   TACTUS_ASSIGN_OR_RETURN(uint64_t number, NextNumber(look, Table::kAudit));
//   TACTUS_RETURN_IF_ERROR(change.Put(Table::kAudit, NumberKey(number),
//   entry));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"

namespace tactus::internal {

// "0000000012".
std::string NumberKey(uint64_t number);

// The number behind the largest key of a table whose keys are numbers; from 1.
absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table);

// The same where records may be removed: also behind the largest number that
// KeepNumber has kept under `name`.
absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table,
                                    const std::string& name);

// Keeps the largest number that was given in `table`, so that it is not given
// again when its record is removed. Call it before.
absl::Status KeepNumber(Transaction& change, Table table,
                        const std::string& name);

// The largest number that was given under `name`, as Table::kNumbers has it; 0
// if it has none.
absl::StatusOr<uint32_t> LastNumber(const Transaction& look,
                                    const std::string& name);

}  // namespace tactus::internal
