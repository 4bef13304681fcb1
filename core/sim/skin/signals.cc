#include "core/sim/skin/signals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/gaussian.h"
#include "core/sim/skin/butterworth.h"

namespace tactus {
namespace {

double UnclampedStrain(const Cube& cube, double force) {
  return force / cube.Stiffness() / cube.edge_m;
}

FeatureVector Variances(const std::vector<FeatureVector>& samples) {
  FeatureVector means = {};
  for (const FeatureVector& sample : samples) {
    for (int f = 0; f < kFeatureCount; ++f) means[f] += sample[f];
  }
  for (double& mean : means) mean /= samples.size();
  FeatureVector sums = {};
  for (const FeatureVector& sample : samples) {
    for (int f = 0; f < kFeatureCount; ++f) {
      sums[f] += (sample[f] - means[f]) * (sample[f] - means[f]);
    }
  }
  for (double& sum : sums) sum /= samples.size();
  return sums;
}

}  // namespace

double Strain(const Cube& cube, double force) {
  return std::min(UnclampedStrain(cube, force), kMaxStrain);
}

double ContactArea(const Cube& cube, double force) {
  return cube.edge_m * cube.edge_m *
         std::pow(1 - Strain(cube, force), -2 * cube.material.poisson_ratio);
}

IdealSignals ReadSignals(const Cube& cube, const Trajectory& trajectory,
                         bool with_area) {
  const double rate = trajectory.sample_rate_hz;
  const size_t stride = static_cast<size_t>(std::lround(rate / kSkinRateHz));
  const auto& raw = trajectory.samples;
  std::array<Butterworth6, 3> filters = {Butterworth6(kAntiAliasHz, rate),
                                         Butterworth6(kAntiAliasHz, rate),
                                         Butterworth6(kAntiAliasHz, rate)};
  IdealSignals signals;
  signals.samples.reserve(raw.size() / stride);
  signals.object_motion.reserve(raw.size() / stride);
  bool clamped = false;
  for (size_t i = 1; i < raw.size(); ++i) {
    const double force = (raw[i].impulse - raw[i - 1].impulse) * rate;
    // Share of the interval spent in contact.
    const double share = (raw[i].contact_time - raw[i - 1].contact_time) * rate;
    double area = 0;
    if (with_area && share > 0) {
      const double pressing = std::max(0.0, force / share);
      area = share * ContactArea(cube, pressing);
      clamped |= UnclampedStrain(cube, pressing) > kMaxStrain;
    }
    const FeatureVector sample = {filters[0].Step(force), filters[1].Step(area),
                                  filters[2].Step(raw[i].x_arm)};
    if (i % stride == 0) {
      signals.samples.push_back(sample);
      signals.object_motion.push_back(raw[i].x_uobj);
      signals.clamped += clamped;
      clamped = false;
    }
  }
  return signals;
}

void AddNoise(const SignalNoise& noise, Random& random,
              std::vector<FeatureVector>& samples) {
  const FeatureVector shares = {noise.force, noise.area, noise.motion};
  FeatureVector deviations = Variances(samples);
  for (int f = 0; f < kFeatureCount; ++f) {
    deviations[f] = std::sqrt(shares[f] * deviations[f]);
  }
  std::vector<double> deviates(kFeatureCount * samples.size());
  FillGaussian(random, deviates);
  for (size_t i = 0; i < samples.size(); ++i) {
    for (int f = 0; f < kFeatureCount; ++f) {
      samples[i][f] += deviations[f] * deviates[kFeatureCount * i + f];
    }
  }
}

}  // namespace tactus
