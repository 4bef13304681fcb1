// File: records.h
//
// Protobuf messages as values of a catalogue.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto dataset, GetRecord<v1::Dataset>(look, Table::kDatasets, "d"));
//   if (!dataset.has_value()) return NoSuch("d");
//
// DATA_LOST if a value is no such message. Thread-safe: free functions without
// state.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/store/catalog.h"

namespace tactus::internal {

template <typename Message>
absl::StatusOr<Message> ParseRecord(absl::string_view key,
                                    absl::string_view value) {
  Message message;
  if (!message.ParseFromArray(value.data(), static_cast<int>(value.size()))) {
    return DataLost(key, "the record cannot be parsed");
  }
  return message;
}

// Nothing if the key does not exist.
template <typename Message>
absl::StatusOr<std::optional<Message>> GetRecord(const Transaction& look,
                                                 Table table,
                                                 absl::string_view key) {
  TACTUS_ASSIGN_OR_RETURN(const auto value, look.Get(table, key));
  if (!value.has_value()) return std::optional<Message>();
  TACTUS_ASSIGN_OR_RETURN(Message message, ParseRecord<Message>(key, *value));
  return std::optional<Message>(std::move(message));
}

template <typename Message>
absl::StatusOr<std::vector<Message>> ScanRecords(const Transaction& look,
                                                 Table table,
                                                 const ScanOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const auto entries, look.Scan(table, options));
  std::vector<Message> messages;
  messages.reserve(entries.size());
  for (const CatalogEntry& entry : entries) {
    TACTUS_ASSIGN_OR_RETURN(Message message,
                            ParseRecord<Message>(entry.key, entry.value));
    messages.push_back(std::move(message));
  }
  return messages;
}

// Runs `visit` on each record, in the order of the keys, and holds few of them
// in memory. It may erase the record that it visits. Ends with its first error.
template <typename Message, typename Visit>
absl::Status VisitRecords(const Transaction& look, Table table,
                          ScanOptions options, const Visit& visit) {
  constexpr int kBatch = 64;
  options.limit = kBatch;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const auto entries, look.Scan(table, options));
    for (const CatalogEntry& entry : entries) {
      TACTUS_ASSIGN_OR_RETURN(const Message message,
                              ParseRecord<Message>(entry.key, entry.value));
      TACTUS_RETURN_IF_ERROR(visit(message));
    }
    if (static_cast<int>(entries.size()) < kBatch) return absl::OkStatus();
    options.after = entries.back().key;
  }
}

inline absl::Status PutRecord(Transaction& change, Table table,
                              absl::string_view key,
                              const google::protobuf::MessageLite& message) {
  return change.Put(table, key, SerializeDeterministic(message));
}

}  // namespace tactus::internal
