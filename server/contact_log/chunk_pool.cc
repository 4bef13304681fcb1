#include "server/contact_log/chunk_pool.h"

namespace tactus::internal::server {
namespace {

int FirstOf(uint64_t head) {
  return static_cast<int32_t>(static_cast<uint32_t>(head));
}

uint64_t HeadAfter(uint64_t head, int first) {
  constexpr int kHalf = 32;
  return (((head >> kHalf) + 1) << kHalf) | static_cast<uint32_t>(first);
}

}  // namespace

ChunkPool::ChunkPool(size_t chunks)
    : head_(HeadAfter(0, 0)),
      next_(std::make_unique<std::atomic<int32_t>[]>(chunks)),
      bytes_(std::make_unique_for_overwrite<uint8_t[]>(
          chunks * limits::kRecordingChunkBytes)) {
  for (size_t i = 0; i + 1 < chunks; ++i) {
    next_[i] = static_cast<int32_t>(i) + 1;
  }
  next_[chunks - 1] = kNone;
}

int ChunkPool::Take() {
  uint64_t head = head_.load(std::memory_order_acquire);
  while (true) {
    const int first = FirstOf(head);
    if (first == kNone) return kNone;
    const int next = next_[first].load(std::memory_order_relaxed);
    if (head_.compare_exchange_weak(head, HeadAfter(head, next),
                                    std::memory_order_acq_rel,
                                    std::memory_order_acquire)) {
      return first;
    }
  }
}

void ChunkPool::Give(int chunk) {
  uint64_t head = head_.load(std::memory_order_relaxed);
  do {
    next_[chunk].store(FirstOf(head), std::memory_order_relaxed);
  } while (!head_.compare_exchange_weak(head, HeadAfter(head, chunk),
                                        std::memory_order_acq_rel,
                                        std::memory_order_relaxed));
}

size_t ChunkPool::free() const {
  size_t count = 0;
  for (int chunk = FirstOf(head_); chunk != kNone; chunk = next_[chunk]) {
    ++count;
  }
  return count;
}

}  // namespace tactus::internal::server
