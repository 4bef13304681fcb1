#include "core/features/touch_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tactus::internal {

TouchFinder::TouchFinder(const SkinLayout& layout, const Options& options)
    : segmenter_(layout, options.skip_untouched),
      contact_threshold_(TaxelThreshold(layout.contact_threshold)),
      onset_threshold_(TaxelThreshold(layout.onset_threshold)),
      columns_(layout.columns) {
  if (!layout.light_touch) return;
  const LightTouch& light = *layout.light_touch;
  light_.emplace(layout, options.sample_rate_hz, options.skip_quiet_rows);
  light_contact_ = static_cast<float>(light.contact_threshold);
  light_onset_ = static_cast<float>(light.onset_threshold);
  light_onset_total_ = light.onset_threshold * light.rows * light.columns;
  light_taxel_ = static_cast<float>(light.contact_threshold *
                                    std::sqrt(light.rows * light.columns));
  fading_ = std::exp(-1 / (light.window_s * options.sample_rate_hz));
}

void TouchFinder::Reset() {
  begins_ = false;
  quiet_rows_ = 0;
  segmenter_.Clear();
  if (light_) light_->Reset();
}

int TouchFinder::Find(std::span<const float> taxels) {
  if (light_) return FindLight(taxels);
  values_ = taxels;
  const int regions = segmenter_.Segment(taxels);
  begins_ = segmenter_.peak() >= onset_threshold_;
  return regions;
}

int TouchFinder::FindLight(std::span<const float> taxels) {
  light_->Step(taxels);
  values_ = light_->values();
  const auto segment = [&](std::span<const float> shape, float threshold) {
    return segmenter_.Segment(shape, threshold, values_);
  };
  begins_ = light_->peak() >= onset_threshold_ ||
            light_->region_peak() >= light_onset_;
  quiet_rows_ = light_->quiet_rows();
  int regions = 0;
  if (light_->has_shape()) {
    regions = segment(light_->shape(), light_taxel_);
  } else {
    segmenter_.Clear();
  }
  if (regions == 0 && light_->peak() >= contact_threshold_) {
    regions = segment(values_, contact_threshold_);
  }
  if (regions == 0 && light_->region_peak() >= light_contact_) {
    regions = segment(light_->shape(), light_contact_);
  }
  return regions;
}

bool TouchFinder::Begins(const RegionPlace& place) const {
  if (place.region.max_value >= onset_threshold_) return true;
  if (!light_ || !light_->has_shape()) return false;
  double total = 0;
  for (int row = place.rows.first(); row < place.rows.end(); ++row) {
    for (uint64_t rest = place.rows[row]; rest != 0; rest &= rest - 1) {
      total += light_->shape()[row * columns_ + std::countr_zero(rest)];
    }
  }
  return total >= light_onset_total_;
}

double TouchFinder::LightPeak(const RegionPlace& place) {
  if (!light_) return 0;
  return light_->RegionPeak(place.rows.words().first(segmenter_.rows().size()));
}

}  // namespace tactus::internal
