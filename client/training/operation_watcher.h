// File: operation_watcher.h
//
// OperationWatcher: follows a job to its end, with the whole learning curve.
//
//   OperationWatcher watcher(&client, {});
//   TACTUS_ASSIGN_OR_RETURN(
//       const v1::Operation ended,
//       watcher.Watch("operations/7", [](const v1::Operation& now,
//                                        const auto& new_points) {
//         Show(now, new_points);
//       }));
//
// If the connection breaks or the server restarts, the watcher connects again;
// each point of the curve is handed over once.
//
// One Watch at a time. Cancel may be called from any thread; the client must
// outlive the watcher.
#pragma once

#include <functional>
#include <mutex>
#include <span>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/training/retry.h"
#include "client/training/training_client.h"

namespace tactus::internal::client {

// True if the job will never change again.
bool HasEnded(const v1::Operation& operation);

class OperationWatcher {
 public:
  // Called for every message, on the thread that calls Watch. `new_points` are
  // those of the learning curve since the call before.
  using OnUpdate = std::function<void(const v1::Operation& operation,
                                      std::span<const v1::LearningPoint>)>;

  OperationWatcher(TrainingClient* client, RetryOptions retry);

  // Returns the operation as it ended, whether it succeeded or not. CANCELLED
  // after Cancel: the job goes on.
  absl::StatusOr<v1::Operation> Watch(const std::string& name,
                                      const OnUpdate& on_update);

  // Ends the watch, not the job.
  void Cancel();

 private:
  absl::Status WatchOnce(const std::string& name, const OnUpdate& on_update);

  TrainingClient* const client_;
  const RetryOptions retry_;
  v1::Operation last_;
  // Points that were handed over.
  size_t points_ = 0;

  std::mutex mutex_;
  bool cancelled_ = false;
  // Context of the call that is under way; null without one.
  grpc::ClientContext* context_ = nullptr;
};

}  // namespace tactus::internal::client
