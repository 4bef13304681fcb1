// File: percentile.h
//
// Percentiles by nearest rank, for measurements. Thread-safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tactus::client {

// The smallest of `values` that at least the share `p` of them do not exceed;
// NaN if there are none.
inline double Percentile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const auto rank =
      static_cast<size_t>(std::ceil(p * static_cast<double>(values.size())));
  return values[std::clamp<size_t>(rank, 1, values.size()) - 1];
}

}  // namespace tactus::client
