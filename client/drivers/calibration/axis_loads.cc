#include "client/drivers/calibration/axis_loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::internal::client {

AxisLoads::AxisLoads(const SkinLayout& layout, CrossAxes matrices)
    : taxels_(static_cast<size_t>(layout.taxels())),
      axes_(static_cast<size_t>(layout.axes)),
      normal_(layout.normal_axis),
      both_ways_(layout.axes > 1 || layout.signed_values),
      matrices_(std::move(matrices)) {}

AxisVector AxisLoads::Of(size_t taxel, std::span<const double> readings) const {
  AxisVector own = {};
  std::copy_n(&readings[axes_ * taxel], axes_, own.begin());
  return OfTaxel(taxel, own);
}

AxisVector AxisLoads::OfTaxel(size_t taxel, const AxisVector& reading) const {
  const CrossAxis* matrix = Matrix(taxel);
  return matrix == nullptr ? reading : matrix->Load(reading);
}

double AxisLoads::Normal(const AxisVector& loads) const {
  if (!both_ways_) return loads[0];
  if (normal_) return std::max(loads[*normal_], 0.0);
  if (axes_ == 1) return std::abs(loads[0]);
  return std::sqrt(loads[0] * loads[0] + loads[1] * loads[1] +
                   loads[2] * loads[2]);
}

double AxisLoads::Step(size_t taxel) const {
  if (Matrix(taxel) == nullptr) return 1;
  double most = 0;
  for (size_t axis = 0; axis < kMostAxes; ++axis) {
    AxisVector reading = {};
    reading[axis] = 1;
    const AxisVector load = OfTaxel(taxel, reading);
    most = std::max(most, normal_ ? std::abs(load[*normal_]) : Normal(load));
  }
  return most;
}

}  // namespace tactus::internal::client
