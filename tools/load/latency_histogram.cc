#include "tools/load/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tactus::internal::client {

void LatencyHistogram::Add(int64_t delay_ns) {
  delay_ns = std::max<int64_t>(0, delay_ns);
  counts_[BucketOf(delay_ns)].fetch_add(1, std::memory_order_relaxed);
  RaiseMax(delay_ns);
}

void LatencyHistogram::Add(const LatencyHistogram& other) {
  other.ForEachBucket(
      [this](size_t i, uint64_t count) { AddToBucket(i, count); });
  RaiseMax(other.max_ns());
}

void LatencyHistogram::AddToBucket(size_t bucket, uint64_t count) {
  if (bucket >= kBuckets) return;
  counts_[bucket].fetch_add(count, std::memory_order_relaxed);
}

void LatencyHistogram::RaiseMax(int64_t delay_ns) {
  int64_t max = max_ns();
  while (delay_ns > max && !max_ns_.compare_exchange_weak(
                               max, delay_ns, std::memory_order_relaxed)) {
  }
}

uint64_t LatencyHistogram::count() const {
  uint64_t count = 0;
  for (const auto& bucket : counts_) {
    count += bucket.load(std::memory_order_relaxed);
  }
  return count;
}

int64_t LatencyHistogram::PercentileNs(double share) const {
  const auto rank =
      static_cast<uint64_t>(std::ceil(share * static_cast<double>(count())));
  uint64_t seen = 0;
  for (size_t i = 0; i < kBuckets; ++i) {
    seen += counts_[i].load(std::memory_order_relaxed);
    if (seen >= rank && seen > 0) return std::min(EndOf(i), max_ns());
  }
  return 0;
}

size_t LatencyHistogram::BucketOf(uint64_t delay_ns) {
  // Delays of the lowest powers of two have a bucket each.
  const int shift =
      std::max(0, static_cast<int>(std::bit_width(delay_ns)) - kBits - 1);
  return (static_cast<size_t>(shift) << kBits) + (delay_ns >> shift);
}

int64_t LatencyHistogram::EndOf(size_t bucket) {
  const size_t whole = bucket >> kBits;
  const size_t shift = whole == 0 ? 0 : whole - 1;
  const size_t mantissa = bucket - (shift << kBits);
  return static_cast<int64_t>(((mantissa + 1) << shift) - 1);
}

}  // namespace tactus::internal::client
