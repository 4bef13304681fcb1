#include "client/drivers/calibration/taxel_faults.h"

#include <algorithm>

#include "client/drivers/calibration/tare.h"

namespace tactus::internal::client {
namespace {

constexpr double kUsualChanges = 0.1;
constexpr double kNoisyTimes = 6;
constexpr double kNoisySteps = 2;

}  // namespace

std::vector<int> TaxelFaults::All() const {
  std::vector<int> all = dead;
  all.insert(all.end(), stuck.begin(), stuck.end());
  all.insert(all.end(), noisy.begin(), noisy.end());
  std::ranges::sort(all);
  return all;
}

TaxelFaults FindFaults(const IdleFrames& idle,
                       const std::vector<double>& baseline,
                       const std::vector<TaxelNoise>& noise) {
  std::vector<double> deviations;
  std::vector<double> changes;
  for (size_t i = 0; i < idle.taxels(); ++i) {
    if (!idle.valid(i)) continue;
    deviations.push_back(noise[i].deviation);
    changes.push_back(noise[i].changes);
  }
  const double noisy = std::max(kNoisyTimes * MedianOf(deviations),
                                kNoisySteps * idle.resolution());
  const bool changing = MedianOf(changes) >= kUsualChanges;
  const std::vector<int> outstanding = OutstandingTaxels(idle, baseline);
  TaxelFaults faults;
  for (size_t i = 0; i < idle.taxels(); ++i) {
    if (!idle.valid(i)) continue;
    const int taxel = static_cast<int>(i);
    if (noise[i].changes > 0) {
      if (noise[i].deviation > noisy) faults.noisy.push_back(taxel);
    } else if (std::ranges::binary_search(outstanding, taxel)) {
      faults.stuck.push_back(taxel);
    } else if (changing) {
      faults.dead.push_back(taxel);
    }
  }
  return faults;
}

std::vector<int> UnfeltTaxels(const IdleFrames& idle,
                              const std::vector<double>& baseline,
                              const std::vector<TaxelNoise>& noise,
                              std::span<const float> largest) {
  std::vector<int> unfelt;
  for (size_t i = 0; i < idle.taxels(); ++i) {
    const double above = largest[i] - baseline[i];
    if (idle.valid(i) && above < noise[i].onset_threshold) {
      unfelt.push_back(static_cast<int>(i));
    }
  }
  return unfelt;
}

}  // namespace tactus::internal::client
