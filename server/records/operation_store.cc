#include "server/records/operation_store.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/dataset_store.h"
#include "server/records/request_key.h"

namespace tactus::internal::server {
namespace {

using v1::Operation;

constexpr char kOperations[] = "operations";
// Operations that are removed in one transaction: of a new operation, and of
// its own.
constexpr size_t kRemovedWithOne = 2;
constexpr size_t kRemovedAtOnce = 50;

absl::StatusOr<Operation> FindByName(const Transaction& look,
                                     const ResourceName& name) {
  TACTUS_ASSIGN_OR_RETURN(
      auto found,
      GetRecord<Operation>(look, Table::kOperations, CatalogKey(name)));
  if (!found.has_value()) {
    return NoSuch(v1::ERROR_REASON_OPERATION_NOT_FOUND, "operation",
                  name.ToString(), "trainctl jobs list shows those that do");
  }
  return *std::move(found);
}

// The operation of an earlier request of `caller` with this id.
absl::StatusOr<std::optional<Operation>> FindIn(const Transaction& look,
                                                absl::string_view request_id,
                                                const Caller& caller) {
  if (const std::string fault = TextFault(request_id, limits::kMaxNameBytes);
      !fault.empty()) {
    return InvalidConfig("request_id", Quoted(request_id), fault);
  }
  if (request_id.empty()) return std::nullopt;
  TACTUS_ASSIGN_OR_RETURN(
      const auto key,
      look.Get(Table::kRequests, RequestKey("operation", caller, request_id)));
  if (!key.has_value()) return std::nullopt;
  return GetRecord<Operation>(look, Table::kOperations, *key);
}

// JOB_LIMIT if no further job may wait.
absl::Status CheckQueue(const Transaction& look) {
  int queued = 0;
  TACTUS_RETURN_IF_ERROR(VisitRecords<Operation>(
      look, Table::kOperations, {}, [&](const Operation& other) {
        queued += other.state() == Operation::STATE_QUEUED ? 1 : 0;
        return absl::OkStatus();
      }));
  if (queued < limits::kMaxQueuedJobs) return absl::OkStatus();
  return JobLimit(limits::kMaxQueuedJobs);
}

// DATASET_NOT_FOUND if the dataset version of a request is gone.
absl::Status CheckDataset(const Transaction& look, const Operation& operation) {
  const std::string& name = operation.has_train()
                                ? operation.train().dataset_version()
                                : operation.evaluate().dataset_version();
  if (name.empty()) return absl::OkStatus();
  return DatasetStore::VersionIn(look, name).status();
}

absl::StatusOr<std::vector<v1::LearningPoint>> PointsOf(
    const Transaction& look, const ResourceName& name) {
  return ScanRecords<v1::LearningPoint>(look, Table::kLearningPoints,
                                        {.prefix = CatalogKey(name) + "/"});
}

}  // namespace

absl::Status OperationStore::Restore() {
  // A server starts on a full disk too.
  return data_->reserve().With([&] {
    return data_->catalog().Change([&](Transaction& change) -> absl::Status {
      return VisitRecords<Operation>(
          change, Table::kOperations, {},
          [&](Operation operation) -> absl::Status {
            if (operation.state() == Operation::STATE_RUNNING) {
              operation.set_state(Operation::STATE_QUEUED);
            } else if (operation.state() == Operation::STATE_CANCELLING) {
              operation.set_state(Operation::STATE_CANCELLED);
              operation.set_end_time_ms(now_());
            } else {
              return absl::OkStatus();
            }
            TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                                    ParseName(operation.name(), kOperations));
            return PutRecord(change, Table::kOperations, CatalogKey(name),
                             operation);
          });
    });
  });
}

absl::StatusOr<Operation> OperationStore::Create(Operation request,
                                                 absl::string_view request_id,
                                                 const Caller& caller) {
  Operation operation = std::move(request);
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        return CreateIn(change, request_id, caller, &operation).status();
      }));
  return operation;
}

absl::StatusOr<bool> OperationStore::CreateIn(Transaction& change,
                                              absl::string_view request_id,
                                              const Caller& caller,
                                              Operation* operation) {
  TACTUS_ASSIGN_OR_RETURN(auto known, FindIn(change, request_id, caller));
  if (known.has_value()) {
    *operation = *std::move(known);
    return false;
  }
  if (operation->state() == Operation::STATE_UNSPECIFIED) {
    operation->set_state(Operation::STATE_QUEUED);
  }
  if (operation->state() == Operation::STATE_QUEUED) {
    // From here on the dataset is in use and can't be deleted.
    TACTUS_RETURN_IF_ERROR(CheckDataset(change, *operation));
    TACTUS_RETURN_IF_ERROR(CheckQueue(change));
    TACTUS_RETURN_IF_ERROR(CheckQueuedJobs(change, quotas_, caller.name));
    if (operation->kind() == Operation::KIND_TRAIN) {
      // Now, and not when the training has ended.
      TACTUS_RETURN_IF_ERROR(CheckModelBytes(change, quotas_, caller.name, 1));
    }
  }
  TACTUS_ASSIGN_OR_RETURN(const uint64_t number,
                          NextNumber(change, Table::kOperations, kOperations));
  operation->set_name(absl::StrCat(kOperations, "/", number));
  operation->set_create_time_ms(now_());
  operation->set_requester(caller.name);
  operation->set_request_id(std::string(request_id));
  const std::string key = NumberKey(number);
  if (!request_id.empty()) {
    TACTUS_RETURN_IF_ERROR(change.Put(
        Table::kRequests, RequestKey("operation", caller, request_id), key));
  }
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kOperations, key, *operation));
  TACTUS_RETURN_IF_ERROR(
      Audit(change, caller, now_(), "create", operation->name()));
  // So that the number of operations is bounded at any time. A client that
  // requests jobs loses its oldest ones, never those of others.
  TACTUS_ASSIGN_OR_RETURN(
      const auto old,
      OldOperations(change, retention_, now_(), kRemovedWithOne));
  for (const Operation& ended : old) {
    TACTUS_RETURN_IF_ERROR(RemoveOperation(change, ended));
  }
  return true;
}

absl::Status OperationStore::Delete(absl::string_view name,
                                    const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  // A full disk must not prevent what makes room.
  TACTUS_RETURN_IF_ERROR(data_->reserve().With([&] {
    return data_->catalog().Change([&](Transaction& change) -> absl::Status {
      TACTUS_ASSIGN_OR_RETURN(const Operation operation,
                              FindByName(change, parsed));
      TACTUS_RETURN_IF_ERROR(
          CheckOwner(caller, operation.name(), operation.requester()));
      if (!HasEnded(operation)) return OperationActive(operation.name());
      TACTUS_RETURN_IF_ERROR(RemoveOperation(change, operation));
      return Audit(change, caller, now_(), "delete", operation.name());
    });
  }));
  Forget(parsed.ToString());
  return absl::OkStatus();
}

absl::StatusOr<int> OperationStore::RemoveOld() {
  int removed = 0;
  while (true) {
    std::vector<Operation> old;
    TACTUS_RETURN_IF_ERROR(data_->reserve().With([&] {
      return data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(
            old, OldOperations(change, retention_, now_(), kRemovedAtOnce));
        for (const Operation& operation : old) {
          TACTUS_RETURN_IF_ERROR(RemoveOperation(change, operation));
          TACTUS_RETURN_IF_ERROR(Audit(change, {"tactusd", ""}, now_(),
                                       "remove", operation.name()));
        }
        return absl::OkStatus();
      });
    }));
    for (const Operation& operation : old) Forget(operation.name());
    removed += static_cast<int>(old.size());
    if (old.size() < kRemovedAtOnce) return removed;
  }
}

absl::StatusOr<std::optional<Operation>> OperationStore::Find(
    absl::string_view request_id, const Caller& caller) const {
  std::optional<Operation> known;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(known, FindIn(look, request_id, caller));
        return absl::OkStatus();
      }));
  return known;
}

absl::StatusOr<Operation> OperationStore::Get(absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  Operation operation;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(operation, FindByName(look, parsed));
        return absl::OkStatus();
      }));
  const std::lock_guard lock(mutex_);
  const auto live = live_.find(name);
  if (live != live_.end() && live->second.progress.has_value() &&
      !HasEnded(operation)) {
    *operation.mutable_progress() = *live->second.progress;
  }
  return operation;
}

absl::StatusOr<Page<Operation>> OperationStore::List(
    int page_size, absl::string_view page_token, Operation::State state) const {
  Page<Operation> page;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        return VisitRecords<Operation>(
            look, Table::kOperations,
            {.after = std::string(page_token), .backwards = true},
            [&](const Operation& operation) -> absl::Status {
              if (!page.next_token.empty() ||
                  (state != Operation::STATE_UNSPECIFIED &&
                   operation.state() != state)) {
                return absl::OkStatus();
              }
              if (static_cast<int>(page.items.size()) == page_size) {
                TACTUS_ASSIGN_OR_RETURN(
                    const ResourceName last,
                    ParseName(page.items.back().name(), kOperations));
                page.next_token = CatalogKey(last);
                return absl::OkStatus();
              }
              page.items.push_back(operation);
              return absl::OkStatus();
            });
      }));
  return page;
}

absl::StatusOr<std::vector<Operation>> OperationStore::InStates(
    const std::vector<Operation::State>& states) const {
  std::vector<Operation> found;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        // A transaction that met another one runs again.
        found.clear();
        return VisitRecords<Operation>(
            look, Table::kOperations, {}, [&](const Operation& operation) {
              if (std::ranges::count(states, operation.state()) > 0) {
                found.push_back(operation);
              }
              return absl::OkStatus();
            });
      }));
  return found;
}

absl::StatusOr<std::vector<v1::LearningPoint>> OperationStore::Points(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  std::vector<v1::LearningPoint> points;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(FindByName(look, parsed).status());
        TACTUS_ASSIGN_OR_RETURN(points, PointsOf(look, parsed));
        return absl::OkStatus();
      }));
  return points;
}

absl::StatusOr<Operation> OperationStore::Change(
    absl::string_view name, absl::FunctionRef<absl::Status(Operation&)> change,
    const Lock* lock) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  Operation operation;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& transaction) -> absl::Status {
        if (lock != nullptr) {
          TACTUS_RETURN_IF_ERROR(lock->StillHeld(transaction));
        }
        TACTUS_ASSIGN_OR_RETURN(operation, FindByName(transaction, parsed));
        TACTUS_RETURN_IF_ERROR(change(operation));
        return PutRecord(transaction, Table::kOperations, CatalogKey(parsed),
                         operation);
      }));
  Wake(parsed.ToString());
  return operation;
}

absl::Status OperationStore::AddPoints(
    absl::string_view name, const std::vector<v1::LearningPoint>& points,
    const Lock* lock) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        if (lock != nullptr) TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
        TACTUS_ASSIGN_OR_RETURN(auto known, PointsOf(change, parsed));
        uint64_t number = known.size();
        for (const v1::LearningPoint& point : points) {
          TACTUS_RETURN_IF_ERROR(PutRecord(
              change, Table::kLearningPoints,
              absl::StrCat(CatalogKey(parsed), "/", NumberKey(++number)),
              point));
        }
        return absl::OkStatus();
      }));
  Wake(parsed.ToString());
  return absl::OkStatus();
}

absl::Status OperationStore::SaveLog(absl::string_view name,
                                     const v1::StoredLog& log) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  return data_->catalog().Change([&](Transaction& change) {
    return PutRecord(change, Table::kJobLogs, CatalogKey(parsed), log);
  });
}

absl::StatusOr<std::optional<v1::StoredLog>> OperationStore::SavedLog(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kOperations));
  std::optional<v1::StoredLog> log;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(log,
                                GetRecord<v1::StoredLog>(look, Table::kJobLogs,
                                                         CatalogKey(parsed)));
        return absl::OkStatus();
      }));
  return log;
}

absl::StatusOr<std::map<Operation::State, uint32_t>>
OperationStore::CountByState() const {
  std::map<Operation::State, uint32_t> counts;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        return VisitRecords<Operation>(look, Table::kOperations, {},
                                       [&](const Operation& operation) {
                                         ++counts[operation.state()];
                                         return absl::OkStatus();
                                       });
      }));
  return counts;
}

void OperationStore::ShowProgress(absl::string_view name,
                                  const v1::OperationProgress& progress) {
  const std::lock_guard lock(mutex_);
  Live& live = live_[std::string(name)];
  live.progress = progress;
  ++live.changes;
  changed_.notify_all();
}

void OperationStore::Wake(const std::string& name) {
  const std::lock_guard lock(mutex_);
  ++live_[name].changes;
  changed_.notify_all();
}

void OperationStore::Forget(const std::string& name) {
  const std::lock_guard lock(mutex_);
  live_.erase(name);
  changed_.notify_all();
}

absl::StatusOr<OperationStore::Update> OperationStore::WaitForChange(
    absl::string_view name, Cursor* cursor,
    std::chrono::milliseconds timeout) const {
  TACTUS_RETURN_IF_ERROR(ParseName(name, kOperations).status());
  {
    std::unique_lock lock(mutex_);
    const auto changes = [&] {
      const auto live = live_.find(name);
      return news_ + (live == live_.end() ? uint64_t{1} : live->second.changes);
    };
    changed_.wait_for(lock, timeout,
                      [&] { return stopping_ || changes() != cursor->change; });
    cursor->change = changes();
  }
  Update update;
  // First the state: points that come in between are then sent now, and a
  // final state is sent with all points.
  TACTUS_ASSIGN_OR_RETURN(update.operation, Get(name));
  TACTUS_ASSIGN_OR_RETURN(auto points, Points(name));
  if (points.size() > cursor->points) {
    update.points.assign(
        points.begin() + static_cast<std::ptrdiff_t>(cursor->points),
        points.end());
    cursor->points = points.size();
  }
  return update;
}

void OperationStore::OnNews() {
  const std::lock_guard lock(mutex_);
  ++news_;
  changed_.notify_all();
}

void OperationStore::StopWaiting() {
  const std::lock_guard lock(mutex_);
  stopping_ = true;
  changed_.notify_all();
}

}  // namespace tactus::internal::server
