// File: touch_finder.h
//
// TouchFinder: where a frame touches the skin, as regions of taxels, and
// whether a contact may begin there. On a skin with light touch
// (light_touch.h) it looks at the means of many readings.
//
//   TouchFinder finder(layout, {.sample_rate_hz = 100});
//   if (finder.Find(frame.taxels) > 0 && finder.begins()) {
//     Use(finder.segmenter().largest());
//   }
//
// A region are taxels at or above contact_threshold. A contact begins when a
// taxel reaches onset_threshold.
//
// On a skin with light touch both thresholds apply to what a taxel reads above
// its background, and a contact also begins when a region's mean reaches
// light_touch.onset_threshold. A region are then the taxels that feel something
// over the window, the level for a single taxel being
// light_touch.contact_threshold times the square root of the taxels in a
// region, as the noise; if there are none, those at contact_threshold at once.
// Its force is what they read above their background at once, so it does not
// lag behind the motion. Nothing begins in the first 0.3 s.
//
// Find() allocates nothing. Not thread-safe; one per stream.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/features/segmenter.h"
#include "core/light_touch/light_touch.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class TouchFinder {
 public:
  struct Options {
    // Above 0.
    double sample_rate_hz = 100;
    // Skips that change no result. skip_untouched: frames without a touched
    // taxel are not segmented. skip_quiet_rows: of a skin with light touch,
    // only regions near taxels that feel something are summed.
    bool skip_untouched = true;
    bool skip_quiet_rows = true;
  };

  // `layout` must be valid.
  TouchFinder(const SkinLayout& layout, const Options& options);

  // Forgets everything, as if new.
  void Reset();

  // The factor by which the means of light touch fall in a frame once a load is
  // gone; 0 without light touch.
  double fading() const { return fading_; }

  // Takes the next frame's values and returns how many regions there are.
  int Find(std::span<const float> taxels);

  // Takes a frame with the values of the frame before, on a skin without light
  // touch.
  void Repeat(std::span<const float> taxels) { values_ = taxels; }

  // The results of the last Find():

  // A contact may begin somewhere on the skin.
  bool begins() const { return begins_; }
  // A contact may begin in this region: a taxel reaches onset_threshold or,
  // with light touch, the means of all its taxels make up a region's at
  // light_touch.onset_threshold.
  bool Begins(const RegionPlace& place) const;
  // The largest mean that light touch has around a taxel of the region, over
  // the window: it lags behind the load. 0 without light touch.
  double LightPeak(const RegionPlace& place);
  // The least mean that is felt; 0 without light touch.
  double least_light() const { return light_contact_; }
  // The loads of the taxels, to sum over regions.
  std::span<const float> values() const { return values_; }
  const Segmenter& segmenter() const { return segmenter_; }
  Segmenter& segmenter() { return segmenter_; }
  // Rows whose regions were not summed.
  int quiet_rows() const { return quiet_rows_; }

 private:
  int FindLight(std::span<const float> taxels);

  Segmenter segmenter_;
  float contact_threshold_;
  float onset_threshold_;
  std::optional<LightTouchFilter> light_;
  // Levels of light touch: that of a region's mean that is felt, that with
  // which a contact begins, and the sum over a region at that level; and that
  // of a single taxel over the window.
  float light_contact_ = 0;
  float light_onset_ = 0;
  double light_onset_total_ = 0;
  float light_taxel_ = 0;
  double fading_ = 0;
  int columns_;
  bool begins_ = false;
  int quiet_rows_ = 0;
  std::span<const float> values_;
};

}  // namespace tactus::internal
