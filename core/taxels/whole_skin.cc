#include "core/taxels/whole_skin.h"

#include <algorithm>
#include <cmath>

#include "core/taxels/components.h"

namespace tactus::internal {
namespace {

constexpr double kSmoothS = 0.05;
constexpr double kShortS = 0.1;
constexpr double kLongS = 0.4;
// Floors of the logarithms, in shares of the load.
constexpr double kShareFloor = 0.02;
constexpr double kTravelFloor = 0.05;

}  // namespace

WholeSkinTracker::WholeSkinTracker(int taxels, double sample_rate_hz)
    : smooth_window_(std::max(1.0, kSmoothS * sample_rate_hz)),
      short_window_(std::max(1.0, kShortS * sample_rate_hz)),
      long_window_(std::max(1.0, kLongS * sample_rate_hz)),
      pattern_(taxels),
      short_mean_(taxels),
      long_mean_(taxels),
      first_mean_(taxels) {}

void WholeSkinTracker::Reset() {
  frames_ = 0;
  travel_ = 0;
  numbers_ = {};
}

double WholeSkinTracker::Weight(double window) const {
  return 1 / std::min(static_cast<double>(frames_), window);
}

void WholeSkinTracker::Step(std::span<const TaxelLoad> all) {
  const auto loads = WithoutComponents(all, static_cast<int>(pattern_.size()));
  ++frames_;
  double force = 0;
  for (const TaxelLoad& load : loads) {
    force += static_cast<double>(load.root) * load.root;
  }
  StepLevels(loads, force);
  StepPatterns(loads, force);
}

void WholeSkinTracker::StepLevels(std::span<const TaxelLoad> loads,
                                  double force) {
  double peak = 0;
  double squares = 0;
  for (const TaxelLoad& load : loads) {
    const double value = static_cast<double>(load.root) * load.root;
    peak = std::max(peak, value);
    squares += value * value;
  }
  const double level[kLevels] = {
      std::sqrt(force), std::sqrt(static_cast<double>(loads.size())),
      force > 0 ? peak / force : 0,
      squares > 0 ? std::log(force * (force / squares)) : 0};
  for (int i = 0; i < kLevels; ++i) {
    if (frames_ == 1) smooth_[i] = slow_[i] = level[i];
    smooth_[i] += Weight(smooth_window_) * (level[i] - smooth_[i]);
    slow_[i] += Weight(long_window_) * (level[i] - slow_[i]);
  }
  numbers_.root_force = smooth_[0];
  numbers_.root_taxels = smooth_[1];
  numbers_.peak_share = smooth_[2];
  numbers_.log_spread = smooth_[3];
  numbers_.force_rate = smooth_[0] - slow_[0];
  numbers_.taxels_rate = smooth_[1] - slow_[1];
  numbers_.peak_share_rate = smooth_[2] - slow_[2];
  numbers_.spread_rate = smooth_[3] - slow_[3];
}

void WholeSkinTracker::StepPatterns(std::span<const TaxelLoad> loads,
                                    double force) {
  std::fill(pattern_.begin(), pattern_.end(), 0.0F);
  if (force > 0) {
    for (const TaxelLoad& load : loads) {
      pattern_[load.taxel] = static_cast<float>(static_cast<double>(load.root) *
                                                load.root / force);
    }
  }
  if (frames_ == 1) {
    short_mean_ = pattern_;
    long_mean_ = pattern_;
    first_mean_ = pattern_;
  }
  const auto short_weight = static_cast<float>(Weight(short_window_));
  const auto long_weight = static_cast<float>(Weight(long_window_));
  const bool first = static_cast<double>(frames_) <= short_window_;
  double change[3] = {};
  double step = 0;
  for (size_t i = 0; i < pattern_.size(); ++i) {
    const float share = pattern_[i];
    const float short_change = share - short_mean_[i];
    const float long_change = share - long_mean_[i];
    const float moved = short_weight * short_change;
    short_mean_[i] += moved;
    long_mean_[i] += long_weight * long_change;
    if (first) first_mean_[i] = short_mean_[i];
    change[0] += std::abs(short_change);
    change[1] += std::abs(long_change);
    change[2] += std::abs(short_mean_[i] - first_mean_[i]);
    step += std::abs(moved);
  }
  travel_ += step / 2;
  for (int i = 0; i < 3; ++i) {
    if (frames_ == 1) smooth_change_[i] = 0;
    smooth_change_[i] +=
        Weight(smooth_window_) * (change[i] / 2 - smooth_change_[i]);
  }
  numbers_.change_short = std::log(smooth_change_[0] + kShareFloor);
  numbers_.change_long = std::log(smooth_change_[1] + kShareFloor);
  numbers_.change_since_onset = std::log(smooth_change_[2] + kShareFloor);
  numbers_.log_travel = std::log(travel_ + kTravelFloor);
}

}  // namespace tactus::internal
