#include "core/questions/consensus.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {

void Consensus(std::span<const double> before, std::span<double> now) {
  const auto best = std::ranges::max_element(now);
  if (!before.empty()) {
    const auto best_before = std::ranges::max_element(before);
    if (best_before - before.begin() == best - now.begin()) {
      if (*best_before < *best) std::ranges::copy(before, now.begin());
      return;
    }
  }
  double sum = 0;
  for (double& probability : now) {
    probability = std::sqrt(probability);
    sum += probability;
  }
  for (double& probability : now) probability /= sum;
}

}  // namespace tactus::internal
