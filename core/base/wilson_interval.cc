#include "core/base/wilson_interval.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {

Interval WilsonInterval(int successes, int count) {
  if (count == 0) return {};
  // The 97.5 % quantile of the normal distribution.
  constexpr double kZ = 1.959963984540054;
  const double n = count;
  const double fraction = successes / n;
  const double middle = fraction + kZ * kZ / (2 * n);
  const double half =
      kZ * std::sqrt(fraction * (1 - fraction) / n + kZ * kZ / (4 * n * n));
  const double scale = 1 + kZ * kZ / n;
  return {std::max(0., (middle - half) / scale),
          std::min(1., (middle + half) / scale)};
}

}  // namespace tactus::internal
