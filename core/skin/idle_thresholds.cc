#include "core/skin/idle_thresholds.h"

#include <algorithm>
#include <cstddef>

namespace tactus::internal {
namespace {

template <typename Value>
double QuantileOf(std::vector<Value>& values, double fraction) {
  const auto place = std::min(
      static_cast<size_t>(fraction * static_cast<double>(values.size())),
      values.size() - 1);
  const auto at = values.begin() + static_cast<ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

IdleThresholds ThresholdsAbove(double median, double high,
                               double least_margin) {
  IdleThresholds found;
  found.margin = std::max((high - median) / 2, least_margin);
  found.contact_threshold = high + found.margin;
  found.onset_threshold = found.contact_threshold + found.margin;
  return found;
}

double IdleQuantile(std::vector<float> values, double fraction) {
  return QuantileOf(values, fraction);
}

double IdleQuantile(std::vector<double> values, double fraction) {
  return QuantileOf(values, fraction);
}

}  // namespace tactus::internal
