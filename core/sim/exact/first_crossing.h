// File: first_crossing.h
//
// The first time at which a polynomial plus damped oscillations falls below
// zero. These are the events that end a phase of the contact model. No crossing
// is missed: the search leaves out an interval only if a bound proves that the
// function stays above zero on it. The bounds come from the Taylor series at
// the start, from chord and curvature, or from the envelopes of the
// oscillations.
//
//   ModalFunction deformation = piece.Deformation();
//   double lost = FirstCrossing(deformation, /*horizon=*/0.5);
//
// Stateless; thread-safe.
#pragma once

#include <array>

#include "core/sim/exact/damped_pair.h"

namespace tactus::internal {

// f(t) = start + slope t + curvature t^2 / 2 + the changes of the pairs since
// 0.
struct ModalFunction {
  double start = 0;  // f(0), exactly
  double slope = 0;
  double curvature = 0;
  // A pair may be null. The second is the faster one.
  std::array<const DampedPair*, 2> pairs = {nullptr, nullptr};
  std::array<PairState, 2> states;

  ModalFunction Negated() const;
};

// The first t in (0, horizon] at which `f` becomes negative; at least `horizon`
// + 1 if there is none. f(0) >= 0; if f(0) = 0 and f falls at once, returns 0.
double FirstCrossing(const ModalFunction& f, double horizon);

}  // namespace tactus::internal
