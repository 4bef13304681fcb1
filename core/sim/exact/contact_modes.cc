#include "core/sim/exact/contact_modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace tactus::internal {
namespace {

using Root = std::complex<double>;

// s^4 + c[3] s^3 + c[2] s^2 + c[1] s + c[0].
using Quartic = std::array<double, 4>;

// s^2 + damping s + stiffness.
struct Quadratic {
  double damping = 0;
  double stiffness = 0;
};

struct Factors {
  Quadratic slow;
  Quadratic fast;
};

// Where the pairs lie far apart, as with a stiff contact or a light object,
// each coefficient is mostly that of one pair. False if this does not settle.
bool Separate(const Quartic& c, Factors& f) {
  f.slow = {};
  f.fast = {c[3], c[2]};
  for (int i = 0; i < 40; ++i) {
    const double stiffness = c[0] / f.fast.stiffness;
    const double damping =
        (c[1] - f.fast.damping * stiffness) / f.fast.stiffness;
    const bool settled =
        std::abs(stiffness - f.slow.stiffness) <= 1e-14 * stiffness;
    f.slow = {damping, stiffness};
    f.fast.damping = c[3] - damping;
    f.fast.stiffness = c[2] - stiffness - damping * f.fast.damping;
    if (!(f.fast.stiffness > 0)) return false;
    if (settled) return true;
  }
  return false;
}

// All roots at once (Aberth's method), from two circles whose radii are the
// undamped frequencies.
std::array<Root, 4> Roots(const Quartic& c) {
  const double middle = c[2] / 2;
  const double fast = middle + std::sqrt(std::max(0.0, middle * middle - c[0]));
  const double slow = c[0] / fast;
  // No conjugates of each other, so that real roots can be found too.
  std::array<Root, 4> roots = {
      std::polar(std::sqrt(fast), 1.7), std::polar(std::sqrt(fast), -2.0),
      std::polar(std::sqrt(slow), 1.8), std::polar(std::sqrt(slow), -2.1)};
  for (int sweep = 0; sweep < 60; ++sweep) {
    double worst = 0;
    for (int i = 0; i < 4; ++i) {
      const Root s = roots[i];
      const Root value = (((s + c[3]) * s + c[2]) * s + c[1]) * s + c[0];
      const Root slope = ((4.0 * s + 3 * c[3]) * s + 2 * c[2]) * s + c[1];
      if (value == 0.0) continue;
      Root others = slope / value;
      for (int j = 0; j < 4; ++j) {
        if (j != i) others -= 1.0 / (s - roots[j]);
      }
      const Root step = 1.0 / others;
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      roots[i] = s - step;
      worst = std::max(worst, std::abs(step) / std::abs(s));
    }
    if (worst < 1e-9) break;
  }
  return roots;
}

Quadratic Product(const Root& a, const Root& b) {
  return {-(a + b).real(), (a * b).real()};
}

// How far two quadratics are from sharing a root, relative to their size.
double Distance(const Quadratic& a, const Quadratic& b) {
  const double damping = a.damping - b.damping;
  const double stiffness = a.stiffness - b.stiffness;
  const double resultant = stiffness * stiffness -
                           b.damping * damping * stiffness +
                           b.stiffness * damping * damping;
  const double size = std::max(a.stiffness, b.stiffness) +
                      std::pow(std::max(a.damping, b.damping), 2);
  return std::abs(resultant) / (size * size);
}

// Pairs the roots into the two real quadratics that are furthest apart;
// conjugates stay together.
Factors Pair(const std::array<Root, 4>& roots) {
  constexpr int kPairings[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}};
  Factors best;
  double best_score = -1;
  for (const auto& p : kPairings) {
    const Root sum = roots[p[0]] + roots[p[1]];
    const Root product = roots[p[0]] * roots[p[1]];
    const Root other_sum = roots[p[2]] + roots[p[3]];
    const Root other_product = roots[p[2]] * roots[p[3]];
    const double imaginary =
        std::abs(sum.imag()) / (std::abs(roots[p[0]]) + std::abs(roots[p[1]])) +
        std::abs(product.imag()) / std::abs(product) +
        std::abs(other_sum.imag()) /
            (std::abs(roots[p[2]]) + std::abs(roots[p[3]])) +
        std::abs(other_product.imag()) / std::abs(other_product);
    const Quadratic a = Product(roots[p[0]], roots[p[1]]);
    const Quadratic b = Product(roots[p[2]], roots[p[3]]);
    // Near-double roots are known to half the digits only.
    const double score =
        (imaginary < 1e-6 ? 1 + Distance(a, b) : 1 / (1 + 1e9 * imaginary));
    if (score > best_score) {
      best_score = score;
      best = a.stiffness < b.stiffness ? Factors{a, b} : Factors{b, a};
    }
  }
  return best;
}

// Newton's method on the coefficients of both factors, which are well
// conditioned where single roots are not.
void Polish(const Quartic& c, Factors& f) {
  for (int step = 0; step < 8; ++step) {
    double& p1 = f.slow.damping;
    double& q1 = f.slow.stiffness;
    double& p2 = f.fast.damping;
    double& q2 = f.fast.stiffness;
    // Residuals of the product's coefficients.
    const double r3 = c[3] - (p1 + p2);
    const double r2 = c[2] - (q1 + q2 + p1 * p2);
    const double r1 = c[1] - (p1 * q2 + p2 * q1);
    const double r0 = c[0] - q1 * q2;
    // Unknown changes (u1, v1) of slow and (u2, v2) of fast solve
    // r = (u1 s + v1) fast + (u2 s + v2) slow; u2 and v2 eliminated first.
    const double u = r3;
    const double v = r2 - p1 * u;
    const double w1 = r1 - q1 * u - p1 * v;
    const double w0 = r0 - q1 * v;
    const double dp = p2 - p1;
    const double dq = q2 - q1;
    // (u1 s + v1)(dp s + dq) = w1 s + w0 modulo slow.
    const double m00 = dq - p1 * dp;
    const double m10 = -q1 * dp;
    const double determinant = m00 * dq - dp * m10;
    if (determinant == 0) return;
    const double u1 = (w1 * dq - dp * w0) / determinant;
    const double v1 = (m00 * w0 - m10 * w1) / determinant;
    const double u2 = u - u1;
    const double v2 = v - v1 - dp * u1;
    p1 += u1;
    q1 += v1;
    p2 += u2;
    q2 += v2;
    if (std::abs(v1) <= 1e-16 * q1 && std::abs(v2) <= 1e-16 * q2) return;
  }
}

Factors SlidingFactors(const ContactScene& scene, double stiffness) {
  const double arm = 1 / scene.arm_mass_kg;
  const double object = stiffness / scene.object_mass_kg;
  const Quartic c = {
      scene.actuator_stiffness * arm * object,
      scene.actuator_damping * arm * object,
      (scene.actuator_stiffness + stiffness) * arm + object,
      scene.actuator_damping * arm,
  };
  Factors factors;
  if (!Separate(c, factors)) factors = Pair(Roots(c));
  Polish(c, factors);
  // The model only loses energy: what is below 0 is rounding.
  factors.slow.damping = std::max(factors.slow.damping, 0.0);
  factors.fast.damping = std::max(factors.fast.damping, 0.0);
  return factors;
}

}  // namespace

ContactModes::ContactModes(const ContactScene& scene)
    : stiffness(scene.object_stiffness),
      arm(scene.actuator_damping / scene.arm_mass_kg,
          scene.actuator_stiffness / scene.arm_mass_kg),
      slow(arm),
      fast(arm) {
  if (!scene.fixed) {
    Factors factors = SlidingFactors(scene, stiffness);
    for (int i = 1; Distance(factors.slow, factors.fast) < 1e-12 && i <= 8;
         ++i) {
      stiffness = scene.object_stiffness * (1 + i * 1e-11);
      factors = SlidingFactors(scene, stiffness);
    }
    slow = DampedPair(factors.slow.damping, factors.slow.stiffness);
    fast = DampedPair(factors.fast.damping, factors.fast.stiffness);
  }
  stuck =
      DampedPair(scene.actuator_damping / scene.arm_mass_kg,
                 (scene.actuator_stiffness + stiffness) / scene.arm_mass_kg);
}

}  // namespace tactus::internal
