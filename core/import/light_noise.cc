#include "core/import/light_noise.h"

#include <algorithm>
#include <cmath>

#include "core/base/limits.h"
#include "core/data/trial_layout.h"
#include "core/data/trial_loads.h"
#include "core/light_touch/light_touch.h"

namespace tactus::internal {
namespace {

constexpr double kWindow = 0.1;  // s
constexpr int kSide = 3;
constexpr double kContactDeviations = 5;
constexpr double kOnsetDeviations = 7;
constexpr size_t kLeastFrames = 200;

// Nothing reaches these thresholds, so that every frame is background.
SkinLayout WithoutThresholds(SkinLayout layout) {
  constexpr double kNever = limits::kMaxTaxelValue;
  layout.contact_threshold = layout.onset_threshold = kNever;
  layout.light_touch = LightTouch{.window_s = kWindow,
                                  .rows = std::min(kSide, layout.rows),
                                  .columns = std::min(kSide, layout.columns),
                                  .contact_threshold = kNever,
                                  .onset_threshold = kNever};
  return layout;
}

}  // namespace

void LightNoise::Add(const Trial& trial) {
  const auto found = LayoutOfTrial(trial);
  if (!found.ok()) return;
  const SkinLayout layout = WithoutThresholds(*found);
  if (!layout_) {
    layout_ = layout;
    squares_.resize(layout.taxels());
  }
  if (layout != *layout_) return;
  LightTouchFilter filter(layout, trial.sample_rate_hz);
  TrialLoads loads(trial.taxels, layout);
  const size_t frames = std::min<size_t>(trial.taxels.frames(), frames_);
  for (size_t t = 0; t < frames; ++t) {
    filter.Step(loads.Frame(t));
    if (!filter.ready()) continue;
    ++counted_;
    for (size_t i = 0; i < squares_.size(); ++i) {
      const double mean = filter.regions()[i];
      squares_[i] += mean * mean;
    }
  }
}

double LightNoise::Deviation() const {
  if (counted_ == 0) return 0;
  return std::sqrt(*std::max_element(squares_.begin(), squares_.end()) /
                   static_cast<double>(counted_));
}

std::optional<LightTouch> LightNoise::Estimate() const {
  const double deviation = Deviation();
  if (counted_ < kLeastFrames ||
      kContactDeviations * deviation < limits::kMinLightThreshold) {
    return std::nullopt;
  }
  LightTouch light = *layout_->light_touch;
  light.contact_threshold = kContactDeviations * deviation;
  light.onset_threshold = kOnsetDeviations * deviation;
  return light;
}

}  // namespace tactus::internal
