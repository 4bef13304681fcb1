// File: aligned_vector.h
//
// AlignedVector: a std::vector whose memory starts on a cache line, so that
// aligned vector loads never cross two lines.
//
//   AlignedVector<float> cells(160);
//
// Thread-safe as std::vector is.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace tactus::internal {

template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  CacheLineAllocator() = default;
  template <typename U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) {}

  T* allocate(size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* pointer, size_t /*count*/) {
    ::operator delete(pointer, kAlignment);
  }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) {
    return true;
  }
};

template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace tactus::internal
