// File: signals.h
//
// The signals that an ideal skin reads from a simulated contact: force F_surf,
// contact area A' and motion x_arm at 100 Hz after the anti-aliasing filter
// (paper, Sections "Contact Area Model" and "Preprocessing and Feature
// Selection").
//
//   const double area = ContactArea(cube, force);
//   AddNoise(SignalNoise(), random, signals.samples);
//
// piece_signals.h computes IdealSignals. Stateless; thread-safe. IdealSignals
// owns its arrays.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/random.h"
#include "core/features/feature.h"
#include "core/sim/model/materials.h"

namespace tactus::internal {

// Largest strain. Without this limit, the smallest soft cubes would be pressed
// flat.
inline constexpr double kMaxStrain = 0.95;

// The fraction of the cube's edge by which `force` (N) compresses it, at most
// kMaxStrain.
double Strain(const Cube& cube, double force);

// A' in m^2 under `force` > 0 (eq. 19): edge^2 (1 - strain)^(-2 nu).
double ContactArea(const Cube& cube, double force);

struct IdealSignals {
  // Sample i is read (i + 1) / 100 s after the touch.
  std::vector<FeatureVector> samples;
  // x_uobj at the instant of each sample, m: neither filtered nor noisy.
  std::vector<double> object_motion;
  // Number of samples during which the strain was clamped.
  int clamped = 0;
};

// Whose variance the noise is a share of. The paper does not state which.
enum class NoiseReading {
  // That of the trial's own signal. The noise then shows from the first frame
  // on how large the signal will be in the end.
  kRelative,
  // kMeanVariance: the same noise in every trial.
  kAbsolute,
};

// The mean over the paper's 1,835 trials (goal 0.019 m, no noise) of a trial's
// variance. On the mean over that set, both readings have the same
// variance.
inline constexpr FeatureVector kMeanVariance = {26.5477, 2.29025e-6,
                                                1.32734e-5};

// Noise variance, as a share of a variance of the signal.
struct SignalNoise {
  double force = 0.005;
  double area = 0.0005;
  double motion = 0.0005;
  NoiseReading reading = NoiseReading::kRelative;
};

// Parses "relative" or "absolute"; INVALID_CONFIG for any other text.
absl::StatusOr<NoiseReading> ParseNoiseReading(absl::string_view name);

// Adds Gaussian noise of zero mean to each signal of one trial.
void AddNoise(const SignalNoise& noise, Random& random,
              std::vector<FeatureVector>& samples);

}  // namespace tactus::internal
