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
                       const std::vector<ValueNoise>& noise) {
  std::vector<double> deviations;
  std::vector<double> changes;
  for (const ValueNoise& value : noise) {
    deviations.push_back(value.deviation);
    changes.push_back(value.changes);
  }
  const AxisVector usual_noise = AxisMedians(idle, deviations);
  const AxisVector usual_changes = AxisMedians(idle, changes);
  const std::vector<bool> outstanding = OutstandingValues(idle, baseline);
  TaxelFaults faults;
  for (size_t taxel = 0; taxel < idle.taxels(); ++taxel) {
    if (!idle.valid(taxel)) continue;
    bool stuck = false;
    bool dead = false;
    bool noisy = false;
    for (size_t axis = 0; axis < idle.axes(); ++axis) {
      const size_t i = idle.axes() * taxel + axis;
      if (noise[i].changes > 0) {
        noisy |= noise[i].deviation > std::max(kNoisyTimes * usual_noise[axis],
                                               kNoisySteps * idle.resolution());
      } else if (outstanding[i]) {
        stuck = true;
      } else {
        dead |= usual_changes[axis] >= kUsualChanges;
      }
    }
    if (!stuck && !dead && !noisy) continue;
    (stuck  ? faults.stuck
     : dead ? faults.dead
            : faults.noisy)
        .push_back(static_cast<int>(taxel));
  }
  return faults;
}

}  // namespace tactus::internal::client
