#include "client/drivers/calibration/press_sweep.h"

#include <algorithm>
#include <limits>

namespace tactus::internal::client {

PressSweep::PressSweep(const IdleFrames& idle, const Calibration& calibration)
    : idle_(idle),
      loads_(calibration.layout, calibration.cross_axis),
      baseline_(calibration.baseline),
      onset_threshold_(calibration.onset_threshold),
      values_(idle.values()),
      readings_(idle.values()),
      largest_(idle.taxels(), -std::numeric_limits<double>::infinity()) {
  for (size_t t = 1; t < idle.frames(); ++t) Compare(idle.Frame(t));
}

void PressSweep::Compare(std::span<const float> values) {
  const std::span<const float> first = idle_.Frame(0);
  for (size_t i = 0; i < values.size(); ++i) {
    changed_ |= values[i] != first[i] && idle_.valid(idle_.TaxelOf(i));
  }
}

void PressSweep::Add(const SkinFrame& frame) {
  RawValues(idle_.info(), frame, values_);
  Compare(values_);
  for (size_t i = 0; i < values_.size(); ++i) {
    readings_[i] = values_[i] - baseline_[i];
  }
  for (size_t taxel = 0; taxel < largest_.size(); ++taxel) {
    largest_[taxel] =
        std::max(largest_[taxel], loads_.Normal(loads_.Of(taxel, readings_)));
  }
}

std::vector<int> PressSweep::Unfelt() const {
  std::vector<int> unfelt;
  for (size_t taxel = 0; taxel < largest_.size(); ++taxel) {
    if (idle_.valid(taxel) && largest_[taxel] < onset_threshold_[taxel]) {
      unfelt.push_back(static_cast<int>(taxel));
    }
  }
  return unfelt;
}

}  // namespace tactus::internal::client
