#include "core/data/frames/frames_trial.h"

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied from the wire as they are");

template <typename Value>
void AppendTaxels(const std::string& bytes, std::vector<Value>& values) {
  const size_t before = values.size();
  values.resize(before + bytes.size() / sizeof(Value));
  std::memcpy(values.data() + before, bytes.data(), bytes.size());
}

}  // namespace

Pose PoseOf(const v1::FrameBatch& frame) {
  const auto& p = frame.poses();
  return {{p[0], p[1], p[2]}, Eigen::Quaterniond(p[6], p[3], p[4], p[5])};
}

Trial TrialOfFrames(const std::deque<v1::FrameBatch>& frames,
                    v1::TaxelType type, double scale, double rate_hz,
                    const SkinLayout& layout) {
  Trial trial;
  trial.sample_rate_hz = rate_hz;
  trial.taxels.SetShape(layout);
  const int64_t start_ns = frames.front().first_capture_time_ns();
  for (const v1::FrameBatch& frame : frames) {
    trial.time.push_back(
        static_cast<double>(frame.first_capture_time_ns() - start_ns) / 1e9);
    if (type == v1::TAXEL_TYPE_UINT16) {
      AppendTaxels(frame.taxels(), trial.taxels.u16);
    } else if (type == v1::TAXEL_TYPE_INT16) {
      AppendTaxels(frame.taxels(), trial.taxels.i16);
    } else {
      AppendTaxels(frame.taxels(), trial.taxels.f32);
    }
    if (frame.poses_size() > 0) trial.poses.push_back(PoseOf(frame));
  }
  if (type != v1::TAXEL_TYPE_FLOAT32) {
    trial.taxels.scale = scale;
  } else {
    for (float& value : trial.taxels.f32) value = ScaledTaxel(value, scale);
  }
  SetSkin(layout, trial);
  return trial;
}

uint64_t MissingFrames(const std::deque<v1::FrameBatch>& frames) {
  uint64_t missing = 0;
  uint64_t expected = frames.front().first_sequence();
  for (const v1::FrameBatch& frame : frames) {
    missing += frame.first_sequence() - expected;
    expected = frame.first_sequence() + 1;
  }
  return missing;
}

}  // namespace tactus::internal
