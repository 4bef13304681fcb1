#include "core/sim/skin/butterworth.h"

#include <cmath>
#include <numbers>

namespace tactus::internal {

Butterworth6::Butterworth6(double cutoff_hz, double rate_hz) {
  using std::numbers::pi;
  const double warped = std::tan(pi * cutoff_hz / rate_hz);
  const double square = warped * warped;
  for (int i = 0; i < 3; ++i) {
    // Analogue section s^2 + 2 cos(angle) s + 1, poles evenly on a circle.
    const double middle = 2 * std::cos(pi * (2 * i + 1) / 12) * warped;
    const double scale = 1 / (1 + middle + square);
    sections_[i].gain = square * scale;
    sections_[i].a1 = 2 * (square - 1) * scale;
    sections_[i].a2 = (1 - middle + square) * scale;
  }
}

double Butterworth6::Step(double sample) {
  for (Section& section : sections_) {
    const double input = section.gain * sample;
    const double output = input + section.s1;
    section.s1 = 2 * input - section.a1 * output + section.s2;
    section.s2 = input - section.a2 * output;
    sample = output;
  }
  return sample;
}

std::array<double, 6> Butterworth6::state() const {
  std::array<double, 6> state;
  for (int i = 0; i < 3; ++i) {
    state[2 * i] = sections_[i].s1;
    state[2 * i + 1] = sections_[i].s2;
  }
  return state;
}

void Butterworth6::set_state(const std::array<double, 6>& state) {
  for (int i = 0; i < 3; ++i) {
    sections_[i].s1 = state[2 * i];
    sections_[i].s2 = state[2 * i + 1];
  }
}

}  // namespace tactus::internal
