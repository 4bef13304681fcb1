// File: percentile.h
//
// Quantiles of measured times, by nearest rank. The result is one of the
// measured values, never an interpolation. An empty measurement has no
// quantile; the result is NaN.
//
//   const double p99 = Percentile(milliseconds, 0.99);
//   const double median = Percentile(seconds, 0.5);
//
// Thread-safe: a function without state. Takes a copy, which it sorts.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tactus::internal::client {

// The p-quantile (nearest rank): the smallest value v such that at least a
// fraction p of `values` is <= v. NaN if there are no values.
inline double Percentile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const auto rank =
      static_cast<size_t>(std::ceil(p * static_cast<double>(values.size())));
  return values[std::clamp<size_t>(rank, 1, values.size()) - 1];
}

}  // namespace tactus::internal::client
