// File: random.h
//
// Seeded random numbers that give the same bits on every platform. The engine
// is std::mt19937_64; the standard library does not fix its distributions.
//
//   Random random(seed);
//   double noise = 0.002 * random.Gaussian();
//
// Not thread-safe: one per thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/base/mersenne_twister.h"

namespace tactus::internal {

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  // An independent generator for the part numbered `stream` of the work that
  // `seed` starts, so that results do not depend on the order of the parts.
  static Random ForStream(uint64_t seed, uint64_t stream) {
    // SplitMix64 finaliser (Steele et al., OOPSLA 2014).
    uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (stream + 1);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return Random(z ^ (z >> 31));
  }

  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  // Fills `bits` with random bits. Uniform() would have taken the upper 53 of
  // each.
  void Fill(std::span<uint64_t> bits) { engine_.Fill(bits); }

  // Uniform in [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * Uniform();
  }

  // Uniform in 0 .. count-1; count > 0.
  uint64_t Index(uint64_t count) {
    // The bias is below count / 2^64.
    return static_cast<uint64_t>(
        (static_cast<unsigned __int128>(engine_()) * count) >> 64);
  }

  // Zero mean, unit variance (Box-Muller).
  double Gaussian() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    const double angle = 2.0 * std::numbers::pi * Uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  MersenneTwister engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace tactus::internal
