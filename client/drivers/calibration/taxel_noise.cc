#include "client/drivers/calibration/taxel_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

AxisVector AxisMedians(const IdleFrames& idle,
                       const std::vector<double>& numbers) {
  AxisVector medians = {};
  for (size_t axis = 0; axis < idle.axes(); ++axis) {
    std::vector<double> valid;
    for (size_t taxel = 0; taxel < idle.taxels(); ++taxel) {
      if (idle.valid(taxel))
        valid.push_back(numbers[idle.axes() * taxel + axis]);
    }
    medians[axis] = MedianOf(std::move(valid));
  }
  return medians;
}

std::vector<ValueNoise> NoiseOf(const IdleFrames& idle,
                                const std::vector<double>& baseline) {
  std::vector<ValueNoise> all(idle.values());
  const auto frames = static_cast<double>(idle.frames());
  for (size_t i = 0; i < all.size(); ++i) {
    ValueNoise& noise = all[i];
    const std::vector<float> series = idle.Series(i);
    double squares = 0;
    for (size_t t = 0; t < series.size(); ++t) {
      squares += std::pow(series[t] - baseline[i], 2);
      if (t > 0 && series[t] != series[t - 1]) noise.changes += 1 / frames;
    }
    noise.deviation = std::sqrt(squares / frames);
  }
  return all;
}

TaxelThresholds ThresholdsOf(const IdleFrames& idle,
                             const std::vector<double>& baseline,
                             const AxisLoads& loads, double least_margin) {
  const double margin = std::max(least_margin, idle.resolution());
  TaxelThresholds thresholds;
  std::vector<double> series(idle.frames());
  for (size_t taxel = 0; taxel < idle.taxels(); ++taxel) {
    for (size_t t = 0; t < series.size(); ++t) {
      AxisVector reading = {};
      for (size_t axis = 0; axis < idle.axes(); ++axis) {
        const size_t i = idle.axes() * taxel + axis;
        reading[axis] = idle.Frame(t)[i] - baseline[i];
      }
      series[t] = loads.Normal(loads.OfTaxel(taxel, reading));
    }
    const IdleThresholds found = ThresholdsAbove(
        IdleQuantile(series, 0.5), IdleQuantile(series, kIdleFraction),
        margin * loads.Step(taxel));
    thresholds.contact.push_back(found.contact_threshold);
    thresholds.onset.push_back(found.onset_threshold);
  }
  return thresholds;
}

std::vector<double> StepNoise(const IdleFrames& idle) {
  std::vector<double> noise(idle.values());
  for (size_t i = 0; i < noise.size(); ++i) {
    const std::vector<float> series = idle.Series(i);
    std::vector<double> steps;
    for (size_t t = 1; t < series.size(); ++t) {
      const double step = std::abs(series[t] - series[t - 1]);
      if (step > 0 || idle.resolution() > 0) steps.push_back(step);
    }
    // A difference has the noise of two values.
    noise[i] = kDeviationsPerMedian * MedianOf(std::move(steps)) / std::sqrt(2);
  }
  const AxisVector medians = AxisMedians(idle, noise);
  for (size_t i = 0; i < noise.size(); ++i) {
    const double least = std::max(kLeastSteps * idle.resolution(),
                                  kLeastOfMedian * medians[i % idle.axes()]);
    noise[i] = std::max(noise[i], least);
  }
  return noise;
}

}  // namespace tactus::internal::client
