// File: touch_thresholds.h
//
// TouchThresholds: whether readings of a taxel are a touch, shear included. A
// tare is refused and a drift is frozen by it.
//
//   const TouchThresholds thresholds(calibration);
//   if (thresholds.Excess(17, readings) >= 0) Freeze();
//
// A taxel is touched if its load is at its contact threshold, and, on a skin of
// three axes or with signs, if the size of its load along the normal axis is.
// Along another axis it takes the contact threshold and 6 deviations of the
// noise of that axis, because the threshold comes from the normal axis.
//
// Nothing but the constructor allocates. Immutable; thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "client/drivers/calibration/axis_loads.h"
#include "client/drivers/calibration/calibration.h"

namespace tactus::internal::client {

class TouchThresholds {
 public:
  explicit TouchThresholds(const Calibration& calibration);

  size_t axes() const { return loads_.axes(); }
  // By how much the loads of a taxel are above what counts as a touch, the
  // axis with the most; from 0 on it is touched. `readings` are those of the
  // whole skin, above the baseline.
  double Excess(size_t taxel, std::span<const double> readings) const;

 private:
  const AxisLoads loads_;
  const std::vector<double> contact_threshold_;
  // Per value; empty if the load alone counts.
  std::vector<double> along_;
};

}  // namespace tactus::internal::client
