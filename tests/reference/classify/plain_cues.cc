#include "tests/reference/classify/plain_cues.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/strip.h"

namespace tactus::internal {
namespace {

// N, m^2 and m.
constexpr long double kPlainFloor[] = {1e-6L, 1e-7L, 1e-7L};

long double FlooredLog(long double x, long double floor) {
  return std::log(std::max(x, floor));
}

long double KneeLog(long double x, long double knee) {
  return std::copysign(std::log1p(std::abs(x) / knee), x);
}

long double Quotient(long double x, long double y) { return y > 0 ? x / y : 0; }

long double UnexplainedLog(long double product, long double x, long double y) {
  const long double explained = Quotient(product, x) * Quotient(product, y);
  return std::log(1.0001L - std::clamp(explained, 0.0L, 1.0L));
}

}  // namespace

void PlainCues::Step(const ContactSample& sample, uint64_t frames_since_onset) {
  frames_since_onset_ = frames_since_onset;
  points_.push_back({sample.net_force,
                     sample.features[static_cast<int>(Feature::kArea)],
                     sample.features[static_cast<int>(Feature::kMotion)],
                     sample.features[static_cast<int>(Feature::kForce)]});
  const size_t count = points_.size();
  smooth_net_.push_back(Smooth(count, kNet));
  smooth_area_.push_back(Smooth(count, kAreaOf));
  log_spring_.push_back(LogSpring(count));
  std::ranges::fill(known_, std::nullopt);
}

std::vector<long double> PlainCues::Weights(size_t count,
                                            long double window) const {
  std::vector<long double> weights(count);
  long double rest = 1;
  for (size_t i = count; i-- > 0;) {
    const long double newest = 1 / std::min<long double>(i + 1, window);
    weights[i] = rest * newest;
    rest *= 1 - newest;
  }
  return weights;
}

long double PlainCues::Mean(const std::vector<long double>& weights,
                            Signal a) const {
  long double sum = 0;
  for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * points_[i][a];
  return sum;
}

long double PlainCues::Covariance(const std::vector<long double>& weights,
                                  Signal a, Signal b) const {
  const long double mean_a = Mean(weights, a);
  const long double mean_b = Mean(weights, b);
  long double sum = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] * (points_[i][a] - mean_a) * (points_[i][b] - mean_b);
  }
  return sum;
}

long double PlainCues::Smooth(size_t count, Signal a) const {
  return Mean(Weights(count, std::max(1.0, 0.05 * rate_)), a);
}

long double PlainCues::Product(size_t count, Signal a, Signal b) const {
  long double sum = 0;
  for (size_t i = 0; i < count; ++i) sum += points_[i][a] * points_[i][b];
  return sum / static_cast<long double>(count);
}

long double PlainCues::Value(Cue cue) const {
  if (points_.empty()) return 0;
  std::optional<long double>& known = known_[static_cast<int>(cue)];
  if (!known) known = Derive(CueName(cue));
  return *known;
}

long double PlainCues::Derive(absl::string_view cue) const {
  if (cue == "force") return points_.back()[kPeak];
  if (cue == "area") return points_.back()[kAreaOf];
  if (cue == "motion") return points_.back()[kMotionOf];
  if (absl::EndsWith(cue, "_roughness")) {
    const Signal signal = cue.front() == 'f'   ? kNet
                          : cue.front() == 'a' ? kAreaOf
                                               : kMotionOf;
    return Roughness(signal, kPlainFloor[signal]);
  }
  if (absl::ConsumeSuffix(&cue, "_short")) return Window(cue, 0.1L * rate_);
  if (absl::ConsumeSuffix(&cue, "_long")) return Window(cue, 0.4L * rate_);
  if (absl::StrContains(cue, "sp") && cue != "log_speed") return Spring(cue);
  if (absl::StrContains(cue, "slope")) return Spring(cue);
  return Level(cue);
}

long double PlainCues::Level(absl::string_view cue) const {
  const size_t count = points_.size();
  const auto log_of = [&](Signal a) {
    return FlooredLog(Smooth(count, a), kPlainFloor[a]);
  };
  const long double log_time =
      std::log(static_cast<long double>(frames_since_onset_) / rate_);
  // The smallest smooth area once 30 ms have passed.
  const size_t settled =
      std::clamp<size_t>(static_cast<size_t>(0.03 * rate_), 1, count);
  const long double first_area = *std::min_element(
      smooth_area_.begin() + static_cast<ptrdiff_t>(settled - 1),
      smooth_area_.end());
  const long double log_largest =
      FlooredLog(*std::ranges::max_element(smooth_net_), kPlainFloor[kNet]);
  if (cue == "log_peak")
    return FlooredLog(Smooth(count, kPeak), kPlainFloor[kNet]);
  if (cue == "log_force") return log_of(kNet);
  if (cue == "log_area") return log_of(kAreaOf);
  if (cue == "log_motion") return log_of(kMotionOf);
  if (cue == "log_time") return log_time;
  if (cue == "log_speed") return log_of(kMotionOf) - log_time;
  if (cue == "log_stiffness") return log_of(kNet) - log_of(kMotionOf);
  if (cue == "log_first_area")
    return FlooredLog(first_area, kPlainFloor[kAreaOf]);
  if (cue == "area_growth")
    return KneeLog((Smooth(count, kAreaOf) - first_area) /
                       std::max(first_area, kPlainFloor[kAreaOf]),
                   1e-5L);
  if (cue == "log_largest_force") return log_largest;
  if (cue == "force_drop") return log_of(kNet) - log_largest;
  if (cue == "log_drag") return log_of(kNet) - 1.5L * log_of(kAreaOf);
  return std::nanl("");
}

long double PlainCues::LogSpring(size_t count) const {
  return FlooredLog(Product(count, kNet, kMotionOf), 1e-13L) -
         FlooredLog(Product(count, kMotionOf, kMotionOf), 1e-14L);
}

long double PlainCues::Spring(absl::string_view cue) const {
  const size_t count = points_.size();
  const std::vector<long double> even(count,
                                      1 / static_cast<long double>(count));
  if (cue == "log_spring") return log_spring_.back();
  if (cue == "log_stiffest_spring")
    return *std::ranges::max_element(log_spring_);
  if (cue == "log_spring_misfit")
    return UnexplainedLog(Product(count, kNet, kMotionOf),
                          Product(count, kMotionOf, kMotionOf),
                          Product(count, kNet, kNet));
  if (cue == "log_slope")
    return FlooredLog(Covariance(even, kNet, kNet), 1e-12L) -
           FlooredLog(Covariance(even, kNet, kMotionOf), 1e-13L);
  return UnexplainedLog(Covariance(even, kNet, kMotionOf),
                        Covariance(even, kMotionOf, kMotionOf),
                        Covariance(even, kNet, kNet));
}

long double PlainCues::Window(absl::string_view cue, long double window) const {
  const auto weights = Weights(points_.size(), std::max(1.0L, window));
  const auto ripple = [&](Signal a) {
    const long double mean =
        std::max(std::abs(Mean(weights, a)), kPlainFloor[a]);
    return 0.5L * std::log(Covariance(weights, a, a) / (mean * mean) + 1e-12L);
  };
  // 0 while `a` rests.
  const auto slope = [&](Signal b, Signal a) {
    const long double variance = Covariance(weights, a, a);
    const long double rest = 1e-7L * Mean(weights, a);
    return variance > rest * rest ? Covariance(weights, b, a) / variance : 0;
  };
  if (cue == "stiffness") return KneeLog(slope(kNet, kMotionOf), 1e3L);
  if (cue == "force_ripple") return ripple(kNet);
  if (cue == "motion_ripple") return ripple(kMotionOf);
  if (cue == "area_ripple") return ripple(kAreaOf);
  return KneeLog(slope(kAreaOf, kNet) * Mean(weights, kNet) /
                     std::max(Mean(weights, kAreaOf), kPlainFloor[kAreaOf]),
                 1e-5L);
}

long double PlainCues::Roughness(Signal a, long double floor) const {
  long double sum = 0;
  for (size_t i = 1; i < points_.size(); ++i) {
    const long double change = points_[i][a] - points_[i - 1][a];
    sum += change * change;
  }
  return 0.5L * std::log(sum / static_cast<long double>(points_.size()) +
                         floor * floor * 1e-6L);
}

}  // namespace tactus::internal
