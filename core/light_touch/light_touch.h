// File: light_touch.h
//
// LightTouchFilter: what each taxel feels above its background, at once and
// smoothed over time, and the mean of what the regions around the taxels feel.
// Averaging n readings divides the noise by sqrt(n), so a region over a window
// of time feels contacts that no single reading shows.
//
//   LightTouchFilter filter(layout, /*sample_rate_hz=*/100);
//   filter.Step(frame.taxels);
//   if (filter.region_peak() >= layout.light_touch->onset_threshold) {
//     segmenter.Segment(filter.shape(), threshold, filter.values());
//   }
//
// A taxel's background is the mean of its readings, over 1 s once there are as
// many. A contact is no background: the taxels of a region rest from when its
// mean reaches the onset_threshold of light_touch, or its middle taxel the
// layout's contact_threshold, until its mean is below the contact_threshold of
// light_touch. If some mean stays at contact_threshold for 10 s and no single
// taxel reaches its threshold in any of these frames, that is taken for a
// drift, and all backgrounds follow until it is over. Frames that went missing
// count for nothing.
//
// Compiled for several vector widths by Highway; all give the same bits.
// Memory is constant; Step() allocates nothing. Not thread-safe: one per
// stream.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/light_touch/region_sum.h"
#include "core/skin/layout.h"

namespace tactus {

class LightTouchFilter {
 public:
  // `layout` must be valid and have light_touch; `sample_rate_hz` above 0.
  // With `skip_quiet_rows`, rows in which no region can reach contact_threshold
  // and no taxel the layout's are left out: their regions() read 0, and
  // region_peak() is that of the other rows. All else keeps its bits.
  LightTouchFilter(const SkinLayout& layout, double sample_rate_hz,
                   bool skip_quiet_rows = false);

  // Forgets everything, as if new.
  void Reset();

  // Takes the next frame of rows x columns finite values, row-major.
  void Step(std::span<const float> taxels);

  // True once the background is known.
  bool ready() const { return frames_ > first_frames_; }

  // The results of the last Step(). All are 0 in the first 0.3 s, which are
  // needed for a background, and for masked taxels.

  // Readings above the background, at least 0.
  std::span<const float> values() const { return values_; }
  // Largest of them.
  float peak() const { return peak_; }

  // Mean above the background of the region around each taxel, over the window.
  // The middle of a region of even size is the taxel before its centre.
  // Masked taxels and those beyond the skin's edge count as 0.
  std::span<const float> regions() const { return regions_; }
  // Largest of them; at least 0.
  float region_peak() const { return region_peak_; }

  // Each taxel's mean above its background over the window, if it is in a
  // region whose mean is at least contact_threshold; else 0. It never differs
  // by more than the layout's contact_threshold from the reading, so that
  // strong contacts begin and end at once.
  std::span<const float> shape() const { return shape_; }
  // False if all of the shape is 0.
  bool has_shape() const { return !shaped_.empty(); }

  // Rows that the last Step() left out.
  int quiet_rows() const { return quiet_rows_; }

 private:
  // Writes all but the marks, the backgrounds and the shape. Returns the rows
  // of all taxels and regions that may be marked.
  RowRange StepMeans(std::span<const float> taxels, float weight,
                     float background_weight);
  // Writes the marks of `rows`; all others are 0.
  void FindMarks(const RowRange& rows);
  // Writes the shape and the backgrounds.
  void Learn(float resting);
  // The rows of all regions that hold a taxel of `rows`.
  RowRange Around(const RowRange& rows, const RegionSum::Region& region) const;
  // The rows of `numbers` that reach `level`, if their largest does.
  RowRange RowsAt(std::span<const float> numbers, float largest,
                  float level) const;
  template <typename Number>
  std::span<Number> Part(std::span<Number> taxels, const RowRange& rows) const {
    return taxels.subspan(rows.begin * columns_, rows.size() * columns_);
  }
  // Sets the rows that are in `was` and not in `now` to 0.
  void Clear(const RowRange& was, const RowRange& now,
             std::span<float> taxels) const;

  size_t taxels_;
  size_t rows_;
  size_t columns_;
  bool skip_quiet_rows_;
  LightTouch light_;
  float contact_threshold_;
  // Weights of a frame in the means, once there are many.
  double window_weight_;
  double background_weight_;
  // Frames until the background is known.
  uint64_t first_frames_;
  // Frames after which a light touch is taken for a drift.
  uint64_t drift_frames_;

  uint64_t frames_ = 0;
  uint64_t light_frames_ = 0;
  // 1 for a valid taxel, else 0; empty if all are valid.
  AlignedVector<float> valid_;
  AlignedVector<float> smooth_;
  AlignedVector<float> background_;
  // The backgrounds after the frame, wherever they do not rest.
  AlignedVector<float> moved_;
  AlignedVector<float> values_;
  SummedTaxels difference_;
  AlignedVector<float> regions_;
  // Marks of the taxels (light_touch_kernels.h), and their sums over all
  // regions that hold the taxel.
  SummedTaxels marks_;
  AlignedVector<float> mark_sums_;
  AlignedVector<float> shape_;
  RegionSum region_sum_;
  RegionSum mark_sum_;
  // Rows outside of which regions_, marks_ and shape_ are 0.
  RowRange summed_;
  RowRange marked_;
  RowRange shaped_;
  int quiet_rows_ = 0;
  float peak_ = 0;
  float region_peak_ = 0;
};

}  // namespace tactus
