#include "server/records/operation_removal.h"

#include <algorithm>
#include <map>
#include <string>

#include "core/base/status_macros.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/request_key.h"

namespace tactus::internal::server {
namespace {

using v1::Operation;

constexpr char kCollection[] = "operations";
constexpr int kKeptAtAnyAge = 100;

// Erases the entries of `table` whose keys begin with `prefix` and whose value
// `wanted` accepts.
template <typename Wanted>
absl::Status EraseAll(Transaction& change, Table table,
                      const std::string& prefix, const Wanted& wanted) {
  TACTUS_ASSIGN_OR_RETURN(const auto entries,
                          change.Scan(table, {.prefix = prefix}));
  for (const CatalogEntry& entry : entries) {
    if (!wanted(entry.value)) continue;
    TACTUS_RETURN_IF_ERROR(change.Erase(table, entry.key));
  }
  return absl::OkStatus();
}

}  // namespace

bool HasEnded(const Operation& operation) {
  return operation.state() == Operation::STATE_SUCCEEDED ||
         operation.state() == Operation::STATE_FAILED ||
         operation.state() == Operation::STATE_CANCELLED;
}

absl::StatusOr<std::vector<Operation>> OldOperations(const Transaction& look,
                                                     const Retention& retention,
                                                     int64_t now_ms,
                                                     size_t limit) {
  std::map<std::string, int> ended;
  std::vector<Operation> old;
  TACTUS_RETURN_IF_ERROR(VisitRecords<Operation>(
      look, Table::kOperations, {.backwards = true},
      [&](const Operation& operation) {
        if (!HasEnded(operation)) return absl::OkStatus();
        const int newer = ended[operation.requester()]++;
        const bool too_many = retention.jobs > 0 && newer >= retention.jobs;
        const int64_t end_ms =
            std::max(operation.create_time_ms(), operation.end_time_ms());
        const bool too_old = retention.ms > 0 && newer >= kKeptAtAnyAge &&
                             now_ms - end_ms > retention.ms;
        if ((too_many || too_old) && old.size() < limit) {
          old.push_back(operation);
        }
        return absl::OkStatus();
      }));
  return old;
}

absl::Status RemoveOperation(Transaction& change, const Operation& operation) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(operation.name(), kCollection));
  const std::string key = CatalogKey(name);
  TACTUS_RETURN_IF_ERROR(KeepNumber(change, Table::kOperations, kCollection));
  const auto all = [](const std::string&) { return true; };
  TACTUS_RETURN_IF_ERROR(
      EraseAll(change, Table::kLearningPoints, key + "/", all));
  TACTUS_RETURN_IF_ERROR(change.Erase(Table::kJobLogs, key));
  // The requests of this client begin alike.
  TACTUS_RETURN_IF_ERROR(EraseAll(
      change, Table::kRequests,
      RequestKey("operation", {operation.requester(), ""}, ""),
      [&](const std::string& operation_key) { return operation_key == key; }));
  return change.Erase(Table::kOperations, key);
}

}  // namespace tactus::internal::server
