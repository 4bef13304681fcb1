#include "client/drivers/calibration/taxel_noise.h"

#include <algorithm>
#include <cmath>

#include "core/skin/idle_thresholds.h"

namespace tactus::internal::client {
namespace {

constexpr double kLeastSteps = 0.3;
constexpr double kLeastOfMedian = 0.25;

}  // namespace

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle =
      values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<TaxelNoise> NoiseOf(const IdleFrames& idle,
                                const std::vector<double>& baseline,
                                double least_margin) {
  std::vector<TaxelNoise> all(idle.taxels());
  const auto frames = static_cast<double>(idle.frames());
  for (size_t i = 0; i < idle.taxels(); ++i) {
    TaxelNoise& noise = all[i];
    std::vector<float> series = idle.Series(i);
    double squares = 0;
    for (size_t t = 0; t < series.size(); ++t) {
      squares += std::pow(series[t] - baseline[i], 2);
      if (t > 0 && series[t] != series[t - 1]) noise.changes += 1 / frames;
    }
    noise.deviation = std::sqrt(squares / frames);
    const IdleThresholds found =
        ThresholdsAbove(IdleQuantile(series, 0.5) - baseline[i],
                        IdleQuantile(series, kIdleFraction) - baseline[i],
                        std::max(least_margin, idle.resolution()));
    noise.contact_threshold = found.contact_threshold;
    noise.onset_threshold = found.onset_threshold;
  }
  return all;
}

std::vector<double> StepNoise(const IdleFrames& idle) {
  std::vector<double> noise(idle.taxels());
  std::vector<double> valid;
  for (size_t i = 0; i < idle.taxels(); ++i) {
    const std::vector<float> series = idle.Series(i);
    std::vector<double> steps;
    for (size_t t = 1; t < series.size(); ++t) {
      steps.push_back(std::abs(series[t] - series[t - 1]));
    }
    // A difference has the noise of two values.
    noise[i] = kDeviationsPerMedian * MedianOf(steps) / std::sqrt(2);
    if (idle.valid(i)) valid.push_back(noise[i]);
  }
  const double least = std::max(kLeastSteps * idle.resolution(),
                                kLeastOfMedian * MedianOf(valid));
  for (double& value : noise) value = std::max(value, least);
  return noise;
}

}  // namespace tactus::internal::client
