#include "core/eval/reliability.h"

#include <algorithm>
#include <array>

namespace tactus::internal {

std::vector<ReliabilityBin> ReliabilityBins(std::span<const Outcome> outcomes) {
  std::array<ReliabilityBin, kReliabilityBins> sums;
  for (const Outcome& outcome : outcomes) {
    const int answer = outcome.answer();
    const double top = outcome.probability[answer];
    ReliabilityBin& bin = sums[std::clamp(
        static_cast<int>(top * kReliabilityBins), 0, kReliabilityBins - 1)];
    bin.mean_probability += top;
    bin.right += answer == outcome.label;
    ++bin.count;
  }
  std::vector<ReliabilityBin> bins;
  for (int i = 0; i < kReliabilityBins; ++i) {
    ReliabilityBin& bin = sums[i];
    if (bin.count == 0) continue;
    bin.low = static_cast<double>(i) / kReliabilityBins;
    bin.high = (i + 1.) / kReliabilityBins;
    bin.mean_probability /= bin.count;
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace tactus::internal
