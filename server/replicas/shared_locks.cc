#include "server/replicas/shared_locks.h"

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_catalog.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"

namespace tactus::internal::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTryAgain(50);
constexpr std::chrono::milliseconds kPatience(limits::kLockPatienceMs);

}  // namespace

class SharedLocks::Held final : public Lock {
 public:
  Held(SharedLocks* locks, std::string name, Lease lease,
       std::unique_ptr<Lock> local)
      : locks_(locks),
        name_(std::move(name)),
        lease_(lease),
        local_(std::move(local)) {}

  ~Held() override {
    if (locks_->ReleaseRecord(name_, lease_.fence).ok()) return;
    const std::lock_guard lock(locks_->mutex_);
    locks_->unreleased_.emplace(name_, lease_.fence);
  }

  absl::Status StillHeld(const Transaction& change) const override {
    TACTUS_ASSIGN_OR_RETURN(
        const auto lease,
        GetRecord<v1::StoredLease>(change, Table::kLeases, name_));
    if (lease.has_value() && lease->fence() == lease_.fence &&
        lease->holder() == locks_->replica_->name()) {
      return absl::OkStatus();
    }
    return TakenOver(name_,
                     lease.has_value() ? lease->holder() : "another one");
  }

  bool taken_over() const override { return lease_.taken_over; }

 private:
  SharedLocks* const locks_;
  const std::string name_;
  const Lease lease_;
  const std::unique_ptr<Lock> local_;
};

absl::StatusOr<std::unique_ptr<Lock>> SharedLocks::Take(
    absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(auto local, local_.Take(name));
  const Clock::time_point until = Clock::now() + kPatience;
  while (true) {
    std::string holder;
    TACTUS_ASSIGN_OR_RETURN(const Lease lease,
                            TakeRecord(std::string(name), &holder));
    if (lease.fence > 0) {
      return std::make_unique<Held>(this, std::string(name), lease,
                                    std::move(local));
    }
    if (Clock::now() >= until) {
      return CatalogUnavailable(name,
                                absl::StrCat(holder, " is at work on it"));
    }
    std::this_thread::sleep_for(kTryAgain);
  }
}

absl::StatusOr<std::unique_ptr<Lock>> SharedLocks::TryTake(
    absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(auto local, local_.TryTake(name));
  if (local == nullptr) return nullptr;
  std::string holder;
  TACTUS_ASSIGN_OR_RETURN(const Lease lease,
                          TakeRecord(std::string(name), &holder));
  if (lease.fence == 0) return nullptr;
  return std::make_unique<Held>(this, std::string(name), lease,
                                std::move(local));
}

absl::StatusOr<SharedLocks::Lease> SharedLocks::TakeRecord(
    const std::string& name, std::string* holder) {
  Lease taken;
  TACTUS_RETURN_IF_ERROR(
      catalog_->Change([&](Transaction& change) -> absl::Status {
        taken = {};
        TACTUS_ASSIGN_OR_RETURN(
            const auto found,
            GetRecord<v1::StoredLease>(change, Table::kLeases, name));
        v1::StoredLease lease = found.value_or(v1::StoredLease());
        *holder = lease.holder();
        taken.taken_over = found.has_value();
        // Its own one, of which no thread knows, is left of a failed release.
        const bool own = lease.holder() == replica_->name();
        if (found.has_value() && !own) {
          // One that has ended gives no more signs; one that this process does
          // not know may just have begun.
          TACTUS_ASSIGN_OR_RETURN(const auto beat,
                                  change.Get(Table::kBeats, lease.holder()));
          if (beat.has_value() && !replica_->IsDead(lease.holder())) {
            return absl::OkStatus();
          }
          lease.set_losses(lease.losses() + 1);
        }
        lease.set_holder(replica_->name());
        lease.set_fence(lease.fence() + 1);
        taken.fence = lease.fence();
        return PutRecord(change, Table::kLeases, name, lease);
      }));
  return taken;
}

absl::Status SharedLocks::ReleaseRecord(const std::string& name,
                                        uint64_t fence) {
  return catalog_->Change([&](Transaction& change) -> absl::Status {
    TACTUS_ASSIGN_OR_RETURN(
        const auto lease,
        GetRecord<v1::StoredLease>(change, Table::kLeases, name));
    if (!lease.has_value() || lease->holder() != replica_->name() ||
        lease->fence() != fence) {
      return absl::OkStatus();
    }
    return change.Erase(Table::kLeases, name);
  });
}

void SharedLocks::ReleaseAgain() {
  std::set<std::pair<std::string, uint64_t>> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(unreleased_);
  }
  for (const auto& [name, fence] : waiting) {
    if (ReleaseRecord(name, fence).ok()) continue;
    const std::lock_guard lock(mutex_);
    unreleased_.emplace(name, fence);
  }
}

}  // namespace tactus::internal::server
