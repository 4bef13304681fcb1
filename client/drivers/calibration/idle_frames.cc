#include "client/drivers/calibration/idle_frames.h"

#include <algorithm>

namespace tactus::internal::client {

IdleFrames::IdleFrames(const SkinInfo& info, size_t frames)
    : info_(info),
      frames_(frames),
      axes_(static_cast<size_t>(info.layout.axes)),
      values_per_frame_(static_cast<size_t>(info.layout.values())),
      values_(frames_ * values_per_frame_) {}

void IdleFrames::Add(const SkinFrame& frame) {
  if (complete()) return;
  RawValues(info_, frame,
            {&values_[count_ * values_per_frame_], values_per_frame_});
  ++count_;
}

double IdleFrames::resolution() const {
  return info_.taxel_type == v1::TAXEL_TYPE_FLOAT32 ? 0 : 1;
}

std::vector<float> IdleFrames::Series(size_t value) const {
  std::vector<float> series(count_);
  for (size_t t = 0; t < count_; ++t) {
    series[t] = values_[t * values_per_frame_ + value];
  }
  return series;
}

void RawValues(const SkinInfo& info, const SkinFrame& frame,
               std::span<float> values) {
  if (info.taxel_type == v1::TAXEL_TYPE_UINT16) {
    std::copy_n(frame.u16.begin(), values.size(), values.begin());
  } else if (info.taxel_type == v1::TAXEL_TYPE_INT16) {
    std::copy_n(frame.i16.begin(), values.size(), values.begin());
  } else {
    std::copy_n(frame.f32.begin(), values.size(), values.begin());
  }
}

}  // namespace tactus::internal::client
