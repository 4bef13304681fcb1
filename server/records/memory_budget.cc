#include "server/records/memory_budget.h"

#include <algorithm>

namespace tactus::internal::server {

MemoryBudget::Lease MemoryBudget::Take(int64_t bytes) {
  const int64_t wanted = std::min(bytes, all_);
  std::unique_lock lock(mutex_);
  const uint64_t number = next_++;
  returned_.wait(lock, [&] { return turn_ == number && free_ >= wanted; });
  free_ -= wanted;
  ++turn_;
  returned_.notify_all();
  return Lease(this, wanted);
}

bool MemoryBudget::TryTake(int64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes > free_) return false;
  free_ -= bytes;
  return true;
}

void MemoryBudget::Return(int64_t bytes) {
  const std::lock_guard lock(mutex_);
  free_ += bytes;
  returned_.notify_all();
}

}  // namespace tactus::internal::server
