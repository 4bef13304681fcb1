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

#include "core/base/random.h"
#include "core/features/feature.h"
#include "core/sim/model/materials.h"

namespace tactus {

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

// Noise variance, relative to the variance of the trial's own signal.
struct SignalNoise {
  double force = 0.005;
  double area = 0.0005;
  double motion = 0.0005;
};

// Adds Gaussian noise of zero mean to each signal of one trial.
void AddNoise(const SignalNoise& noise, Random& random,
              std::vector<FeatureVector>& samples);

}  // namespace tactus
