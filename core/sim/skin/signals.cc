#include "core/sim/skin/signals.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/gaussian.h"

namespace tactus::internal {
namespace {

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
  return std::min(force / cube.Stiffness() / cube.edge_m, kMaxStrain);
}

double ContactArea(const Cube& cube, double force) {
  return cube.edge_m * cube.edge_m *
         std::pow(1 - Strain(cube, force), -2 * cube.material.poisson_ratio);
}

absl::StatusOr<NoiseReading> ParseNoiseReading(absl::string_view name) {
  if (name == "relative") return NoiseReading::kRelative;
  if (name == "absolute") return NoiseReading::kAbsolute;
  return InvalidConfig("noise", name, "relative or absolute");
}

void AddNoise(const SignalNoise& noise, Random& random,
              std::vector<FeatureVector>& samples) {
  const FeatureVector shares = {noise.force, noise.area, noise.motion};
  FeatureVector deviations = noise.reading == NoiseReading::kAbsolute
                                 ? kMeanVariance
                                 : Variances(samples);
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

}  // namespace tactus::internal
