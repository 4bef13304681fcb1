#include "core/sim/exact/damped_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tactus::internal {
namespace {

// Terms of the power series that reach double precision at Short() times.
constexpr int kPairTerms = 14;
constexpr double kNegligible = 1e-18;
// Longer than any contact, s.
constexpr double kEndlessReach = 1e9;

constexpr std::array<double, kPairTerms + 2> kPairInverse = [] {
  std::array<double, kPairTerms + 2> inverse = {};
  for (size_t n = 1; n < inverse.size(); ++n) inverse[n] = 1.0 / n;
  return inverse;
}();

}  // namespace

DampedPair::DampedPair(double damping, double stiffness)
    : damping_(damping), stiffness_(stiffness), decay_(damping / 2) {
  const double root = std::sqrt(stiffness);
  // (root - decay) (root + decay) does not lose a small difference.
  const double square = (root - decay_) * (root + decay_);
  frequency_ = square > 0 ? std::sqrt(square) : 0;
  split_ = square < 0 ? std::sqrt(-square) : 0;
  fastest_ = square < 0 ? decay_ + split_ : root;
  slowest_ = stiffness / fastest_;
  // The sine over its frequency is at most the time, so that its envelope
  // peaks at 1 / e / the slower decay.
  const double slower = split_ > 0 ? slowest_ : decay_;
  reach_ = slower > 0 ? 1 / (std::numbers::e * slower) : kEndlessReach;
  if (frequency_ > 0) reach_ = std::min(reach_, 1 / frequency_);
  if (split_ > 0) reach_ = std::min(reach_, 0.5 / split_);
}

DampedPair::Basis DampedPair::At(double t) const {
  if (split_ > 0) {
    const double slow = std::exp(-slowest_ * t);
    const double ratio = std::expm1(-2 * split_ * t);
    return {slow * (1 + ratio / 2), -slow * ratio / (2 * split_)};
  }
  const double envelope = std::exp(-decay_ * t);
  if (frequency_ == 0) return {envelope, envelope * t};
  return {envelope * std::cos(frequency_ * t),
          envelope * std::sin(frequency_ * t) / frequency_};
}

PairState DampedPair::Change(const PairState& start, double t) const {
  if (Short(t)) {
    // y^(n+2) = -p y^(n+1) - q y^(n); `value` and `rate` are the n-th terms
    // y^(n) t^n / n! and y^(n+1) t^n / n!.
    PairState sum;
    double value = start.value;
    double rate = start.rate;
    for (int n = 1; n <= kPairTerms; ++n) {
      const double step = kPairInverse[n] * t;
      const double next = -(damping_ * rate + stiffness_ * value) * step;
      value = rate * step;
      rate = next;
      sum.value += value;
      sum.rate += rate;
      if (std::abs(value) <= kNegligible * std::abs(sum.value) &&
          std::abs(rate) <= kNegligible * std::abs(sum.rate)) {
        break;
      }
    }
    return sum;
  }
  const Basis basis = At(t);
  const double mixed = start.rate + decay_ * start.value;
  return {start.value * (basis.cosine - 1) + mixed * basis.sine,
          start.rate * (basis.cosine - 1) -
              (stiffness_ * start.value + decay_ * start.rate) * basis.sine};
}

double DampedPair::Integral(const PairState& start, double t) const {
  if (Short(t)) {
    double sum = start.value * t;
    double value = start.value * t;
    double rate = start.rate * t;
    for (int n = 1; n <= kPairTerms; ++n) {
      const double step = kPairInverse[n + 1] * t;
      const double next = -(damping_ * rate + stiffness_ * value) * step;
      value = rate * step;
      rate = next;
      sum += value;
      if (std::abs(value) <= kNegligible * std::abs(sum) && n > 2) break;
    }
    return sum;
  }
  if (split_ > 0.01 * fastest_) {
    // Two decays: value = slow part + fast part.
    const double slow = (start.rate + fastest_ * start.value) / (2 * split_);
    const double fast = start.value - slow;
    return -slow * std::expm1(-slowest_ * t) / slowest_ -
           fast * std::expm1(-fastest_ * t) / fastest_;
  }
  const PairState change = Change(start, t);
  return -(change.rate + damping_ * change.value) / stiffness_;
}

double DampedPair::Bound(const PairState& start, double span) const {
  const double value = std::abs(start.value);
  const double mixed = std::abs(start.rate + decay_ * start.value);
  const double sum = value + mixed * std::min(span, reach_);
  if (frequency_ * span <= 1) return sum;
  const double sine = mixed / frequency_;
  return std::min(sum, std::sqrt(value * value + sine * sine));
}

}  // namespace tactus::internal
