// File: light_touch_reference.h
//
// LightTouchReference: the definition of LightTouchFilter, one taxel at a time
// and without any trick. It rounds each step as the filter does, so their
// results have the same bits.
//
//   LightTouchReference reference(layout, /*sample_rate_hz=*/100);
//   reference.Step(taxels);
//   EXPECT_EQ(filter.peak(), reference.peak());
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/skin/layout.h"

namespace tactus::internal {

class LightTouchReference {
 public:
  LightTouchReference(const SkinLayout& layout, double sample_rate_hz);

  void Step(std::span<const float> taxels);

  const std::vector<float>& values() const { return values_; }
  const std::vector<float>& regions() const { return regions_; }
  const std::vector<float>& shape() const { return shape_; }
  float peak() const;
  float region_peak() const;
  bool has_shape() const { return has_shape_; }
  // The last frame was taken for a drift.
  bool drifts() const { return light_frames_ > 10 * rate_; }

 private:
  // What a region in the middle of which is (row, column) has of one row, from
  // left to right.
  float SumOfRow(const std::vector<float>& taxels, int row, int column) const;
  float SumOfRegion(const std::vector<float>& taxels, int row,
                    int column) const;
  // Calls with each taxel of a region.
  template <typename Use>
  void ForRegion(int row, int column, const Use& use) const;
  bool Valid(size_t taxel) const;

  SkinLayout layout_;
  LightTouch light_;
  double rate_;
  int frames_ = 0;
  int light_frames_ = 0;
  bool has_shape_ = false;
  std::vector<float> smooth_;
  std::vector<float> background_;
  std::vector<float> values_;
  std::vector<float> regions_;
  std::vector<float> shape_;
  std::vector<char> touched_;
};

}  // namespace tactus::internal
