// File: latency_histogram.h
//
// LatencyHistogram: percentiles of many delays, in buckets less than 1 % wide.
//
//   histogram.Add(delay_ns);
//   histogram.PercentileNs(0.99);
//   all.Add(histogram);
//
// Add of a delay may be called from any thread and locks nothing. What is read
// while others add is a moment's view.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace tactus::internal::client {

class LatencyHistogram {
 public:
  // A negative delay counts as 0.
  void Add(int64_t delay_ns);
  // Adds all delays of `other`; they keep their buckets.
  void Add(const LatencyHistogram& other);

  // Delays that another histogram had in a bucket, and its maximum. Ignores
  // buckets that do not exist.
  void AddToBucket(size_t bucket, uint64_t count);
  void RaiseMax(int64_t delay_ns);
  // Calls `visit` with the number and the count of each bucket that has delays.
  template <typename Visit>
  void ForEachBucket(Visit visit) const {
    for (size_t i = 0; i < kBuckets; ++i) {
      const uint64_t count = counts_[i].load(std::memory_order_relaxed);
      if (count > 0) visit(i, count);
    }
  }

  uint64_t count() const;
  int64_t max_ns() const { return max_ns_.load(std::memory_order_relaxed); }
  // By nearest rank, rounded up to its bucket's end but not above the maximum;
  // 0 if there are none. 0 < share <= 1.
  int64_t PercentileNs(double share) const;

 private:
  // Every power of two is cut into 128 equal buckets.
  static constexpr int kBits = 7;
  static constexpr size_t kBuckets = (64 - kBits) << kBits;

  static size_t BucketOf(uint64_t delay_ns);
  // The largest delay in it.
  static int64_t EndOf(size_t bucket);

  std::array<std::atomic<uint64_t>, kBuckets> counts_ = {};
  std::atomic<int64_t> max_ns_ = 0;
};

}  // namespace tactus::internal::client
