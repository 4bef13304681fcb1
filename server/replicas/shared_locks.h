// File: shared_locks.h
//
// SharedLocks: locks among all processes that share a catalogue. A lock is a
// record there, which names its holder; if the holder dies, another process
// takes it over. What a holder changes counts only while the record is still
// its own (Lock::StillHeld), so one that was only slow changes nothing.
//
//   SharedLocks locks(&catalog, replica);
//   TACTUS_ASSIGN_OR_RETURN(const auto lock, locks.TryTake("operations/7"));
//
// Thread-safe. What it is given must outlive it, and it its locks.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "core/store/catalog.h"
#include "core/store/locks.h"
#include "server/replicas/replica.h"

namespace tactus::internal::server {

class SharedLocks final : public Locks {
 public:
  SharedLocks(Catalog* catalog, Replica* replica)
      : catalog_(catalog), replica_(replica) {}

  absl::StatusOr<std::unique_ptr<Lock>> Take(absl::string_view name) override;
  absl::StatusOr<std::unique_ptr<Lock>> TryTake(
      absl::string_view name) override;

  // Releases those that could not be released when they ended, because the
  // database was away.
  void ReleaseAgain();

 private:
  class Held;
  struct Lease {
    // 0: somebody else has it.
    uint64_t fence = 0;
    bool taken_over = false;
  };

  // Takes the record; `holder` receives who had it.
  absl::StatusOr<Lease> TakeRecord(const std::string& name,
                                   std::string* holder);
  absl::Status ReleaseRecord(const std::string& name, uint64_t fence);

  Catalog* const catalog_;
  Replica* const replica_;
  // Among the threads of this process.
  LocalLocks local_;
  std::mutex mutex_;
  std::set<std::pair<std::string, uint64_t>> unreleased_;
};

}  // namespace tactus::internal::server
