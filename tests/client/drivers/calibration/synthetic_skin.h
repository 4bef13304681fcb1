// File: synthetic_skin.h
//
// SyntheticSkin: a skin of counts whose offsets, noise, gains, drift and faults
// are known, as a driver. Test-only.
//
//   SyntheticSkin skin({.rows = 4, .columns = 8});
//   skin.offset[3] = 120;
//   skin.load = [](int64_t frame, size_t taxel) { return 0.; };
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
};

class SyntheticSkin : public SkinDriver {
 public:
  explicit SyntheticSkin(const SyntheticShape& shape)
      : offset(taxels(shape), 50),
        noise(taxels(shape), shape.noise),
        stuck(taxels(shape), -1),
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
  }

  // Counts.
  std::vector<double> offset;
  std::vector<double> noise;
  // At least 0: the taxel reads this.
  std::vector<int> stuck;
  // Counts that are added.
  std::function<double(int64_t frame, size_t taxel)> load =
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
    frame.u16.resize(offset.size());
    for (size_t i = 0; i < offset.size(); ++i) {
      const double value =
          offset[i] + load(frame_, i) + noise[i] * random_.Gaussian();
      frame.u16[i] = static_cast<uint16_t>(
          stuck[i] >= 0 ? stuck[i]
                        : std::clamp(std::lround(value), 0L, 65535L));
    }
    frame.capture_time_ns = 10'000'000 * ++frame_;
    return ReadResult::kFrame;
  }

 private:
  static size_t taxels(const SyntheticShape& shape) {
    return static_cast<size_t>(shape.rows) * shape.columns;
  }

  const SyntheticShape shape_;
  Random random_;
  int64_t frame_ = 0;
};

}  // namespace tactus::internal::client::testing
