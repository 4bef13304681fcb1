// File: locks.h
//
// Locks: what one at a time may do, by name. LocalLocks serves the threads of
// one process; servers that share a catalogue have locks in it
// (server/replicas/shared_locks.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const auto lock, locks->Take("datasets"));
//   return catalog.Change([&](Transaction& change) -> absl::Status {
//     TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
//     return change.Erase(Table::kDatasets, "d");
//   });
//
// Thread-safe; a Lock may be handed from thread to thread. Both must outlive
// their locks.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"

namespace tactus::internal {

// Ends with the object.
class Lock {
 public:
  virtual ~Lock() = default;
  // ABORTED if somebody else has it by now, because this process was taken for
  // dead. Then `change` must not change anything.
  virtual absl::Status StillHeld(const Transaction& change) const = 0;
  // True if the one who had it before may still be at work: it was taken for
  // dead.
  virtual bool taken_over() const { return false; }
};

class Locks {
 public:
  virtual ~Locks() = default;
  // Waits while somebody else has it. CATALOG_UNAVAILABLE.
  virtual absl::StatusOr<std::unique_ptr<Lock>> Take(
      absl::string_view name) = 0;
  // Null if somebody else has it. CATALOG_UNAVAILABLE.
  virtual absl::StatusOr<std::unique_ptr<Lock>> TryTake(
      absl::string_view name) = 0;
};

class LocalLocks final : public Locks {
 public:
  absl::StatusOr<std::unique_ptr<Lock>> Take(absl::string_view name) override;
  absl::StatusOr<std::unique_ptr<Lock>> TryTake(
      absl::string_view name) override;

 private:
  class Held;

  std::mutex mutex_;
  std::condition_variable released_;
  std::set<std::string, std::less<>> held_;
};

}  // namespace tactus::internal
