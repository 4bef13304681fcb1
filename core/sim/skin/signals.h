// File: signals.h
//
// What an ideal skin reads from a simulated contact: force F_surf, contact
// area A' and motion x_arm at 100 Hz behind the anti-aliasing filter (paper,
// Sections "Contact Area Model" and "Preprocessing and Feature Selection").
//
//   IdealSignals signals = ReadSignals(cube, trajectory);
//
// Stateless; thread-safe. Results own their arrays.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/features/feature.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/trajectory.h"
#include "core/sim/skin/block_filter.h"

namespace tactus {

// The smallest soft cubes would be pressed flat: strain stops here.
inline constexpr double kMaxStrain = 0.95;

// Share of the cube's edge that `force` (N) takes, at most kMaxStrain.
double Strain(const Cube& cube, double force);

// A' in m^2 under `force` > 0 (eq. 19): edge^2 (1 - strain)^(-2 nu).
double ContactArea(const Cube& cube, double force);

struct IdealSignals {
  // Sample i is read (i + 1) / 100 s after the touch.
  std::vector<FeatureVector> samples;
  // x_uobj at the instant of each sample, m: neither filtered nor noisy.
  std::vector<double> object_motion;
  // Samples in whose time the strain had to be clamped.
  int clamped = 0;
};

// Force and area enter the filter as means over each interval of the
// trajectory, 0 while apart, so that short impacts count with their impulse.
// The trajectory's rate must be a multiple of 100 Hz above 400 Hz. Without
// `area`, that signal stays 0.
IdealSignals ReadSignals(const Cube& cube, const Trajectory& trajectory,
                         bool area = true);

// Noise variance as a share of the variance of the trial's own signal.
struct SignalNoise {
  double force = 0.005;
  double area = 0.0005;
  double motion = 0.0005;
};

// Adds Gaussian noise of zero mean to each signal of one trial.
void AddNoise(const SignalNoise& noise, Random& random,
              std::vector<FeatureVector>& samples);

}  // namespace tactus
