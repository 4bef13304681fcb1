#include "client/drivers/calibration/touch_thresholds.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal::client {
namespace {

constexpr double kShearDeviations = 6;

}  // namespace

TouchThresholds::TouchThresholds(const Calibration& calibration)
    : loads_(calibration.layout, calibration.cross_axis),
      contact_threshold_(calibration.contact_threshold) {
  if (!loads_.both_ways() || !loads_.normal_axis()) return;
  const auto normal = static_cast<size_t>(*loads_.normal_axis());
  for (size_t taxel = 0; taxel < loads_.taxels(); ++taxel) {
    const double* deviation = &calibration.deviation[loads_.axes() * taxel];
    const CrossAxis* matrix = loads_.Matrix(taxel);
    for (size_t axis = 0; axis < loads_.axes(); ++axis) {
      double squares = std::pow(deviation[axis], 2);
      if (matrix != nullptr) {
        squares = 0;
        for (size_t from = 0; from < kMostAxes; ++from) {
          squares += std::pow(matrix->rows[axis][from] * deviation[from], 2);
        }
      }
      const double noise =
          axis == normal ? 0 : kShearDeviations * std::sqrt(squares);
      along_.push_back(std::max(contact_threshold_[taxel], noise));
    }
  }
}

double TouchThresholds::Excess(size_t taxel,
                               std::span<const double> readings) const {
  const AxisVector loads = loads_.Of(taxel, readings);
  double excess = loads_.Normal(loads) - contact_threshold_[taxel];
  if (along_.empty()) return excess;
  for (size_t axis = 0; axis < loads_.axes(); ++axis) {
    excess = std::max(
        excess, std::abs(loads[axis]) - along_[loads_.axes() * taxel + axis]);
  }
  return excess;
}

}  // namespace tactus::internal::client
