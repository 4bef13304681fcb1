#include "server/metrics/histogram.h"

#include <algorithm>

namespace tactus::internal::server {

void Histogram::Data::Add(const Data& other) {
  at_most.resize(other.at_most.size());
  for (size_t b = 0; b < at_most.size(); ++b) at_most[b] += other.at_most[b];
  count += other.count;
  sum += other.sum;
}

void Histogram::Observe(double value, uint64_t times) {
  const auto place = std::ranges::lower_bound(bounds_, value) - bounds_.begin();
  counts_[place].fetch_add(times, std::memory_order_relaxed);
  sum_.fetch_add(value * static_cast<double>(times), std::memory_order_relaxed);
}

Histogram::Data Histogram::Read() const {
  Data data;
  for (const auto& count : counts_) {
    data.count += count.load(std::memory_order_relaxed);
    data.at_most.push_back(data.count);
  }
  data.at_most.pop_back();
  data.sum = sum_.load(std::memory_order_relaxed);
  return data;
}

}  // namespace tactus::internal::server
