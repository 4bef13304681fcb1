// File: first_crossing.h
//
// The first time at which a polynomial plus damped oscillations falls below
// zero: the events that end a phase of the contact model. No crossing is
// skipped: a stretch is passed only when a bound proves that the function
// stays above zero on it, by its Taylor series at the start, by its chord and
// curvature, or by the envelopes of its oscillations.
//
//   ModalFunction deformation = piece.Deformation();
//   double lost = FirstCrossing(deformation, /*horizon=*/0.5);
//
// Stateless; thread-safe.
#pragma once

#include <array>

#include "core/sim/exact/damped_pair.h"

namespace tactus {

// f(t) = start + slope t + curvature t^2 / 2 + changes of the pairs since 0.
struct ModalFunction {
  double start = 0;  // f(0), exactly
  double slope = 0;
  double curvature = 0;
  // A pair may be null. The second is the faster one.
  std::array<const DampedPair*, 2> pairs = {nullptr, nullptr};
  std::array<PairState, 2> states;

  ModalFunction Negated() const;
};

// The first t in (0, horizon] at which `f` turns negative; `horizon` + 1 or
// more if there is none. f(0) >= 0; where f(0) = 0 and f falls at once, 0.
double FirstCrossing(const ModalFunction& f, double horizon);

}  // namespace tactus
