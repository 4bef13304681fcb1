// File: operation_store.h
//
// OperationStore: what was requested, how far it is, and how it ended. Every
// state is stored before anybody sees it.
//
//   auto operation = operations.Create(request, request_id, caller);
//   auto changed = operations.Change(name, [](v1::Operation& operation) {
//     operation.set_state(v1::Operation::STATE_RUNNING);
//     return absl::OkStatus();
//   });
//   auto update = operations.WaitForChange(name, &cursor, timeout);
//
// Progress that is not stored yet is at most a second old when the server
// crashes; the learning curve and states are never lost.
//
// Errors: INVALID_NAME, OPERATION_NOT_FOUND, JOB_LIMIT, QUOTA_EXCEEDED, and
// those of storage. Thread-safe. `data` must outlive it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"
#include "server/records/caller.h"
#include "server/records/operation_removal.h"
#include "server/records/paging.h"
#include "server/records/quotas.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class OperationStore {
 public:
  // How much of an operation a watcher has seen.
  struct Cursor {
    uint64_t change = 0;
    size_t points = 0;
  };
  struct Update {
    v1::Operation operation;
    std::vector<v1::LearningPoint> points;
  };

  OperationStore(DataDirectory* data, NowMs now, const Quotas& quotas = {},
                 const Retention& retention = {})
      : data_(data),
        now_(std::move(now)),
        quotas_(quotas),
        retention_(retention) {}

  // Puts the operations that were RUNNING or CANCELLING when the server ended
  // back into a state from which they go on. Call it once, first.
  absl::Status Restore();

  // Stores `request` (kind and request are set) as a new operation, in the
  // state QUEUED unless it has another one, or returns the operation of an
  // earlier request of this caller with this id. DATASET_NOT_FOUND if the
  // dataset version of a queued operation does not exist.
  absl::StatusOr<v1::Operation> Create(v1::Operation request,
                                       absl::string_view request_id,
                                       const Caller& caller);
  // As Create, in a transaction of the caller. Returns true if it made an
  // operation, and false if there was one; `operation` is the request, then the
  // operation.
  absl::StatusOr<bool> CreateIn(Transaction& change,
                                absl::string_view request_id,
                                const Caller& caller, v1::Operation* operation);
  // The operation of an earlier request of this caller with this id.
  absl::StatusOr<std::optional<v1::Operation>> Find(
      absl::string_view request_id, const Caller& caller) const;
  absl::StatusOr<v1::Operation> Get(absl::string_view name) const;
  // The newest first.
  absl::StatusOr<Page<v1::Operation>> List(int page_size,
                                           absl::string_view page_token,
                                           v1::Operation::State state) const;
  // Operations that are in one of `states`, the oldest first.
  absl::StatusOr<std::vector<v1::Operation>> InStates(
      const std::vector<v1::Operation::State>& states) const;
  absl::StatusOr<std::vector<v1::LearningPoint>> Points(
      absl::string_view name) const;

  // Changes an operation, stores it, and wakes watchers. The function's error
  // becomes the result, and nothing changes.
  // Nothing changes either if `lock` is no longer held.
  absl::StatusOr<v1::Operation> Change(
      absl::string_view name,
      absl::FunctionRef<absl::Status(v1::Operation&)> change,
      const Lock* lock = nullptr);
  // Removes an operation that has ended. OPERATION_ACTIVE if it has not;
  // PERMISSION_DENIED for others than its requester and admins.
  absl::Status Delete(absl::string_view name, const Caller& caller);
  // Removes the operations that are not to be kept any longer; returns their
  // number.
  absl::StatusOr<int> RemoveOld();
  // Appends to the learning curve.
  absl::Status AddPoints(absl::string_view name,
                         const std::vector<v1::LearningPoint>& points,
                         const Lock* lock = nullptr);
  // Keeps the log of a job, in place of the one before.
  absl::Status SaveLog(absl::string_view name, const v1::StoredLog& log);
  // The log that was saved last; nothing if none was.
  absl::StatusOr<std::optional<v1::StoredLog>> SavedLog(
      absl::string_view name) const;
  // The number of operations in each state that any has, by state.
  absl::StatusOr<std::map<v1::Operation::State, uint32_t>> CountByState() const;
  // Shows watchers a progress without storing it.
  void ShowProgress(absl::string_view name,
                    const v1::OperationProgress& progress);

  // Returns what is behind `cursor`, and moves it; waits for news if there is
  // none, at most for `timeout`. The update is empty of points if none came.
  absl::StatusOr<Update> WaitForChange(absl::string_view name, Cursor* cursor,
                                       std::chrono::milliseconds timeout) const;
  // Other servers may have changed any operation: wakes all watchers.
  void OnNews();
  // Ends all waits, now and later.
  void StopWaiting();

 private:
  struct Live {
    uint64_t changes = 1;
    std::optional<v1::OperationProgress> progress;
  };

  void Wake(const std::string& name);
  // Forgets what was live of it; who waits for it learns that it is gone.
  void Forget(const std::string& name);

  DataDirectory* const data_;
  const NowMs now_;
  const Quotas quotas_;
  const Retention retention_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  // By name; of operations that changed since the start.
  std::map<std::string, Live, std::less<>> live_;
  // How often OnNews was called.
  uint64_t news_ = 0;
  bool stopping_ = false;
};

}  // namespace tactus::internal::server
