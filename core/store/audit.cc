#include "core/store/audit.h"

#include "core/base/status_macros.h"
#include "core/store/numbers.h"
#include "core/store/records.h"

namespace tactus::internal {

absl::Status AppendAudit(Transaction& change, const v1::AuditEntry& entry) {
  TACTUS_ASSIGN_OR_RETURN(const uint64_t number,
                          NextNumber(change, Table::kAudit));
  return PutRecord(change, Table::kAudit, NumberKey(number), entry);
}

}  // namespace tactus::internal
