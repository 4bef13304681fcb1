// File: damped_pair.h
//
// The closed-form solution of y'' + p y' + q y = 0 (p >= 0, q > 0): a damped
// oscillation, a double decay or two decays. Every phase of the contact model
// (contact_phase.h) is a polynomial plus one or two of these.
//
//   DampedPair pair(/*damping=*/2 * 21.6, /*stiffness=*/465);
//   PairState later = pair.After({0.001, 0}, 0.02);
//
// Short times use the power series, which keeps the difference to the start
// exact, so nearly equal roots need no special case. Immutable once built;
// thread-safe. Source: paper, eqs. 9 to 11.
#pragma once

namespace tactus::internal {

struct PairState {
  double value = 0;
  double rate = 0;  // d(value)/dt
};

class DampedPair {
 public:
  DampedPair() : DampedPair(0, 1) {}
  DampedPair(double damping, double stiffness);

  // The state `t` >= 0 seconds after `start`.
  PairState After(const PairState& start, double t) const {
    const PairState change = Change(start, t);
    return {start.value + change.value, start.rate + change.rate};
  }
  // The state after `t` minus the state at the start.
  PairState Change(const PairState& start, double t) const;
  // Integral of the value over the first `t` seconds.
  double Integral(const PairState& start, double t) const;
  // A bound on |value| from the start up to `span` seconds.
  double Bound(const PairState& start, double span) const;

  // The state of the derivative, which is a pair of the same kind: value y',
  // rate y''.
  PairState Derivative(const PairState& state) const {
    return {state.rate, -damping_ * state.rate - stiffness_ * state.value};
  }

  double damping() const { return damping_; }
  double stiffness() const { return stiffness_; }
  // The larger magnitude of the two roots, 1/s.
  double fastest() const { return fastest_; }
  // The faster of its decays, 1/s.
  double FastestDecay() const { return decay_ + split_; }

 private:
  // exp(-damping t / 2) times the cosine and the sine over its frequency.
  struct Basis {
    double cosine;
    double sine;
  };
  Basis At(double t) const;
  bool Short(double t) const { return fastest_ * t < 0.25; }

  double damping_;
  double stiffness_;
  double decay_;      // damping / 2
  double frequency_;  // of the oscillation; 0 if there is none
  double split_;      // half the distance of two real roots; 0 if complex
  double slowest_;    // the smaller real root, if real
  double fastest_;
  double reach_;  // largest value of the sine over its frequency, s
};

}  // namespace tactus::internal
