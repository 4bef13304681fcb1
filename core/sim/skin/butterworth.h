// File: butterworth.h
//
// The anti-aliasing filter of the skin: a Butterworth low-pass of order 6, as
// three second-order sections (bilinear transform, cut-off prewarped).
// Causal, gain 1 at rest; delays by about 0.6 / cutoff seconds.
//
//   Butterworth6 filter(200, 2000);
//   for (double sample : samples) filtered.push_back(filter.Step(sample));
//
// Not thread-safe: it keeps the state of one signal, zero at the start.
#pragma once

#include <array>

namespace tactus::internal {

class Butterworth6 {
 public:
  // 0 < cutoff_hz < rate_hz / 2.
  Butterworth6(double cutoff_hz, double rate_hz);

  double Step(double sample);

  // The filter's state: two numbers per section, first section first.
  std::array<double, 6> state() const;
  void set_state(const std::array<double, 6>& state);

 private:
  // gain (1 + z^-1)^2 / (1 + a1 z^-1 + a2 z^-2), transposed direct form II.
  struct Section {
    double gain = 0;
    double a1 = 0;
    double a2 = 0;
    double s1 = 0;
    double s2 = 0;
  };
  std::array<Section, 3> sections_;
};

}  // namespace tactus::internal
