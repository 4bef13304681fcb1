// File: synthetic_skin.h
//
// SyntheticSkin: a skin of counts whose offsets, noise, gains, drift and faults
// are known, as a driver. A skin of three axes sends int16, and its numbers
// come in the order of core/skin/layout.h. Test-only.
//
//   SyntheticSkin skin({.rows = 4, .columns = 8});
//   skin.offset[3] = 120;
//   skin.load = [](int64_t frame, size_t value) { return 0.; };
//   skin.Configure();
//
// Not thread-safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "client/drivers/skin_driver.h"
#include "core/base/random.h"

namespace tactus::internal::client::testing {

struct SyntheticShape {
  int rows = 4;
  int columns = 8;
  // Standard deviation, counts.
  double noise = 2;
  uint64_t seed = 1;
  // The data ends after so many frames; 0: never.
  int64_t frames = 0;
  // 3: with signs, and the load along z.
  int axes = 1;
};

class SyntheticSkin : public SkinDriver {
 public:
  explicit SyntheticSkin(const SyntheticShape& shape)
      : offset(values(shape), 50),
        noise(values(shape), shape.noise),
        stuck(values(shape), -1),
        shape_(shape),
        random_(shape.seed) {
    info.layout = {.name = "synthetic",
                   .rows = shape.rows,
                   .columns = shape.columns,
                   .row_pitch_m = 0.01,
                   .column_pitch_m = 0.01,
                   .taxel_area_m2 = 1e-4,
                   .unit = TaxelUnit::kCounts,
                   .contact_threshold = 10,
                   .onset_threshold = 15};
    info.sample_rate_hz = 100;
    if (shape.axes == 1) return;
    info.taxel_type = v1::TAXEL_TYPE_INT16;
    info.layout.axes = shape.axes;
    info.layout.normal_axis = 2;
    info.layout.signed_values = true;
  }

  // Counts.
  std::vector<double> offset;
  std::vector<double> noise;
  // At least 0: the value reads this.
  std::vector<int> stuck;
  // Counts that are added.
  std::function<double(int64_t frame, size_t value)> load =
      [](int64_t, size_t) { return 0.; };
  SkinInfo info;

  int64_t frame() const { return frame_; }
  DriverStatistics Statistics() const override {
    DriverStatistics statistics;
    for (size_t i = 0; i < stuck.size(); ++i) {
      if (stuck[i] > 0) {
        statistics.stuck_taxels.push_back(static_cast<int>(i));
      }
    }
    return statistics;
  }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override { return info; }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    if (shape_.frames > 0 && frame_ == shape_.frames) {
      return ReadResult::kEndOfData;
    }
    const bool is_signed = info.taxel_type == v1::TAXEL_TYPE_INT16;
    const long least = is_signed ? -32768 : 0;
    const long most = is_signed ? 32767 : 65535;
    frame.u16.resize(is_signed ? 0 : offset.size());
    frame.i16.resize(is_signed ? offset.size() : 0);
    for (size_t i = 0; i < offset.size(); ++i) {
      const double value =
          offset[i] + load(frame_, i) + noise[i] * random_.Gaussian();
      const long number = stuck[i] >= 0
                              ? stuck[i]
                              : std::clamp(std::lround(value), least, most);
      if (is_signed) {
        frame.i16[i] = static_cast<int16_t>(number);
      } else {
        frame.u16[i] = static_cast<uint16_t>(number);
      }
    }
    frame.capture_time_ns = 10'000'000 * ++frame_;
    return ReadResult::kFrame;
  }

 private:
  static size_t values(const SyntheticShape& shape) {
    return static_cast<size_t>(shape.rows) * shape.columns * shape.axes;
  }

  const SyntheticShape shape_;
  Random random_;
  int64_t frame_ = 0;
};

}  // namespace tactus::internal::client::testing
