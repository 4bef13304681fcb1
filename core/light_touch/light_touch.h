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
#include "core/light_touch/light_touch_kernels.h"
#include "core/light_touch/region_kernels.h"
#include "core/light_touch/region_sum.h"
#include "core/light_touch/row_marks.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class LightTouchFilter {
 public:
  // `layout` must be valid and have light_touch; `sample_rate_hz` above 0.
  // With `skip_quiet_rows`, only what a contact needs is computed: regions()
  // may not be read; region_peak() is right if it is at contact_threshold, and
  // else only below; values() read 0 in rows without a shape, where all are
  // below the layout's contact_threshold. All else keeps its bits.
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

  // The largest of them around the taxels of `rows`, one word per row with bit
  // c for column c; at least 0. Not in the first 0.3 s.
  float RegionPeak(std::span<const uint64_t> rows);

  // Each taxel's mean above its background over the window, if it is in a
  // region whose mean is at least contact_threshold; else 0. It never differs
  // by more than the layout's contact_threshold from the reading, so that
  // strong contacts begin and end at once.
  std::span<const float> shape() const { return shape_; }
  // False if all of the shape is 0.
  bool has_shape() const { return has_shape_; }

  // Rows in which the last Step() summed no regions.
  int quiet_rows() const { return quiet_rows_; }

 private:
  // Writes both peaks, and which taxels are felt and touched. Returns the rows
  // of those that are felt.
  RowRange Mark(const light_touch::Readings& readings);
  // Both write the largest region of `rows`, and their marks if one is felt.
  // The first is for regions of 3 x 3 taxels and does not write regions_.
  void MarkSquares(const RowRange& rows, const light_touch::Readings& readings,
                   const light_touch::Levels& levels);
  void MarkRegions(const RowRange& rows, const light_touch::Readings& readings,
                   const light_touch::Levels& levels);
  // The rows in which some region may be at contact_threshold.
  RowRange LoudRows() const;
  // Writes the values and the shape, of which rows near the `felt` ones have
  // one. Taxels near touched ones get their backgrounds back if they `rest`.
  void Learn(const light_touch::Readings& readings, const RowRange& felt,
             bool rest);
  template <typename Number>
  std::span<Number> Part(std::span<Number> taxels, const RowRange& rows) const {
    return taxels.subspan(rows.begin * columns_, rows.size() * columns_);
  }
  // Clears marks of the rows that are in `was` and not in `now`.
  void ClearMarks(const RowRange& was, const RowRange& now);
  // Sets the rows that are in `was` and not in `now` to 0.
  void Clear(const RowRange& was, const RowRange& now,
             std::span<float> taxels) const;

  size_t taxels_;
  size_t rows_;
  size_t columns_;
  bool skip_quiet_rows_;
  LightTouch light_;
  float contact_threshold_;
  // One taxel's share in the mean of a region.
  float share_;
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
  AlignedVector<float> shape_;
  // The taxels that are felt and those that are touched (region_kernels.h), and
  // the taxels in their regions.
  RowMarks felt_;
  RowMarks touched_;
  RowMarks near_felt_;
  RowMarks near_touched_;
  RegionSum region_sum_;
  // The taxels whose regions hold a taxel.
  light_touch::Surroundings holders_;
  // Rows outside of which felt_ and touched_ are 0, and values_ and shape_.
  RowRange marked_;
  RowRange learned_;
  bool has_shape_ = false;
  int quiet_rows_ = 0;
  float peak_ = 0;
  float region_peak_ = 0;
};

}  // namespace tactus::internal
