// File: mini_kernels.h
//
// The kernels of MiniRocket: all 84 ways to give three of nine taps the weight
// 2 and the other six -1, so that the weights of each sum to 0. A kernel of
// dilation d takes every d-th of the values so far.
//
//   for (int k = 0; k < kMiniKernels; ++k) sum += kTaps.weight[j][k] * x[k];
//
// Source: A. Dempster et al., "MiniRocket: A Very Fast (Almost) Deterministic
// Transform for Time Series Classification" (KDD 2021). Constants.
#pragma once

#include <array>

namespace tactus::internal {

inline constexpr int kMiniTaps = 9;
inline constexpr int kMiniKernels = 84;
// The kernels of one tap lie together; padded to whole vectors with weights of
// 0.
inline constexpr int kMiniLanes = 88;
inline constexpr std::array<int, 6> kMiniDilations = {1, 2, 4, 8, 16, 32};
inline constexpr int kMiniDilationCount = kMiniDilations.size();
// Thresholds with which the values of a kernel are compared.
inline constexpr int kMiniThresholds = 4;
// Frames that the longest kernel reaches over.
inline constexpr int kMiniReach = (kMiniTaps - 1) * kMiniDilations.back() + 1;

struct MiniTaps {
  // Tap 0 is that of the newest frame.
  std::array<std::array<float, kMiniLanes>, kMiniTaps> weight = {};
};

constexpr MiniTaps MakeMiniTaps() {
  MiniTaps taps;
  int kernel = 0;
  for (int a = 0; a < kMiniTaps; ++a) {
    for (int b = a + 1; b < kMiniTaps; ++b) {
      for (int c = b + 1; c < kMiniTaps; ++c) {
        for (int tap = 0; tap < kMiniTaps; ++tap) {
          const bool heavy = tap == a || tap == b || tap == c;
          taps.weight[tap][kernel] = heavy ? 2.0F : -1.0F;
        }
        ++kernel;
      }
    }
  }
  return taps;
}

inline constexpr MiniTaps kTaps = MakeMiniTaps();

}  // namespace tactus::internal
