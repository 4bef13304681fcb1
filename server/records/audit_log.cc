#include "server/records/audit_log.h"

#include "absl/strings/numbers.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::server {

absl::StatusOr<uint64_t> NextNumber(const Transaction& look, Table table) {
  TACTUS_ASSIGN_OR_RETURN(const auto last,
                          look.Scan(table, {.limit = 1, .backwards = true}));
  uint64_t number = 0;
  if (!last.empty() && !absl::SimpleAtoi(last.front().key, &number)) {
    return DataLost(last.front().key, "the key is not a number");
  }
  return number + 1;
}

absl::Status Audit(Transaction& change, const Caller& caller, int64_t now_ms,
                   absl::string_view verb, absl::string_view name) {
  v1::AuditEntry entry;
  entry.set_time_ms(now_ms);
  entry.set_caller(caller.name);
  entry.set_peer(caller.peer);
  entry.set_verb(std::string(verb));
  entry.set_resource(std::string(name));
  TACTUS_ASSIGN_OR_RETURN(const uint64_t number,
                          NextNumber(change, Table::kAudit));
  return PutRecord(change, Table::kAudit, NumberKey(number), entry);
}

}  // namespace tactus::server
