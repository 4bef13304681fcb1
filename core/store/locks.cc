#include "core/store/locks.h"

#include <utility>

namespace tactus::internal {

class LocalLocks::Held final : public Lock {
 public:
  Held(LocalLocks* locks, std::string name)
      : locks_(locks), name_(std::move(name)) {}
  ~Held() override {
    {
      const std::lock_guard lock(locks_->mutex_);
      locks_->held_.erase(name_);
    }
    locks_->released_.notify_all();
  }
  absl::Status StillHeld(const Transaction&) const override {
    return absl::OkStatus();
  }

 private:
  LocalLocks* const locks_;
  const std::string name_;
};

absl::StatusOr<std::unique_ptr<Lock>> LocalLocks::Take(absl::string_view name) {
  std::unique_lock lock(mutex_);
  released_.wait(lock, [&] { return !held_.contains(name); });
  held_.emplace(name);
  return std::make_unique<Held>(this, std::string(name));
}

absl::StatusOr<std::unique_ptr<Lock>> LocalLocks::TryTake(
    absl::string_view name) {
  const std::lock_guard lock(mutex_);
  if (!held_.emplace(name).second) return nullptr;
  return std::make_unique<Held>(this, std::string(name));
}

}  // namespace tactus::internal
