// File: record_seal.h
//
// The seal of a catalogue's record: its CRC32C, which stands behind its value.
// What the databases check themselves does not tell whether a value is the one
// that was written under this key.
//
//   const std::string stored = SealRecord(Table::kAliases, key, value);
//   TACTUS_ASSIGN_OR_RETURN(value, UnsealRecord(Table::kAliases, key, stored));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"

namespace tactus::internal {

using RecordSeal = uint32_t;

// `value`, and its seal behind it.
std::string SealRecord(Table table, absl::string_view key,
                       absl::string_view value);

// The value of a sealed record. DATA_LOST if the seal is another one.
absl::StatusOr<std::string> UnsealRecord(Table table, absl::string_view key,
                                         std::string sealed);

// The smallest text that is above all texts that begin with `prefix`; empty if
// there is none.
std::string EndOfPrefix(std::string prefix);

}  // namespace tactus::internal
