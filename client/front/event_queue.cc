#include "client/front/event_queue.h"

#include <algorithm>
#include <utility>

#include "core/base/limits.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kFirstRoom = 16;

}  // namespace

void EventQueue::Add(const Event& event) {
  const std::lock_guard lock(mutex_);
  if (count_ == limits::kMaxPolledEvents) {
    first_ = (first_ + 1) % ring_.size();
    --count_;
    ++dropped_;
  } else if (count_ == ring_.size()) {
    Grow();
  }
  ring_[(first_ + count_) % ring_.size()] = event;
  ++count_;
}

bool EventQueue::Poll(Event& event) {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) return false;
  std::swap(event, ring_[first_]);
  first_ = (first_ + 1) % ring_.size();
  --count_;
  return true;
}

uint64_t EventQueue::dropped() {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void EventQueue::Grow() {
  std::rotate(ring_.begin(), ring_.begin() + static_cast<ptrdiff_t>(first_),
              ring_.end());
  first_ = 0;
  ring_.resize(std::min(std::max(kFirstRoom, 2 * ring_.size()),
                        limits::kMaxPolledEvents));
}

}  // namespace tactus::internal::client
