#include "core/store/numbers.h"

#include <algorithm>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

std::string NumberKey(uint64_t number) {
  return absl::StrFormat("%010d", number);
}

absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table) {
  TACTUS_ASSIGN_OR_RETURN(const auto last,
                          look.Scan(table, {.limit = 1, .backwards = true}));
  uint64_t number = 0;
  if (!last.empty() && !absl::SimpleAtoi(last.front().key, &number)) {
    return DataLost(last.front().key, "the key is not a number");
  }
  return number + 1;
}

absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table,
                                    const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const uint64_t next, NextNumber(look, table));
  TACTUS_ASSIGN_OR_RETURN(const uint64_t removed, LastNumber(look, name));
  return std::max(next, removed + 1);
}

absl::Status KeepNumber(Transaction& change, Table table,
                        const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const uint64_t next, NextNumber(change, table, name));
  return change.Put(Table::kNumbers, name, NumberKey(next - 1));
}

absl::StatusOr<uint32_t> LastNumber(const Transaction& look,
                                    const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const auto value, look.Get(Table::kNumbers, name));
  uint32_t number = 0;
  if (value.has_value() && !absl::SimpleAtoi(*value, &number)) {
    return DataLost(name, "its last number is not a number");
  }
  return number;
}

}  // namespace tactus::internal
