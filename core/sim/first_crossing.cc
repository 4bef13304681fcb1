#include "core/sim/first_crossing.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr int kDerivatives = 4;

// The function seen from one point: its state there and its derivatives.
class Scan {
 public:
  explicit Scan(const ModalFunction& f) : f_(&f), states_(f.states) {
    value_ = f.start;
  }

  double value() const { return value_; }

  double Fastest() const {
    double rate = 0;
    for (const DampedPair* pair : f_->pairs) {
      if (pair != nullptr) rate = std::max(rate, pair->fastest());
    }
    return rate;
  }

  // Derivatives 1 to 4 at this point, each pair's share of them, and bounds
  // on those shares over the next `span` seconds.
  void Differentiate(double span) {
    derivative_.fill(0);
    derivative_[1] = f_->slope + f_->curvature * time_;
    derivative_[2] = f_->curvature;
    size_ = derivative_;
    for (double& size : size_) size = std::abs(size);
    for (int i = 0; i < 2; ++i) {
      bound_[i].fill(0);
      if (f_->pairs[i] == nullptr) continue;
      PairState state = states_[i];
      for (int n = 1; n <= kDerivatives; ++n) {
        state = f_->pairs[i]->Derivative(state);
        derivative_[n] += state.value;
        size_[n] += std::abs(state.value);
        bound_[i][n] = f_->pairs[i]->Bound(state, span);
      }
    }
  }

  // True if the Taylor series at this point proves the function positive
  // within `span`: some derivative outlasts the bound on the next, and none
  // before it is negative beyond rounding.
  bool TaylorPositive(double span) const {
    for (int n = 0; n < kDerivatives; ++n) {
      const double here = n == 0 ? value_ : derivative_[n];
      const double next =
          bound_[0][n + 1] + bound_[1][n + 1] +
          (n == 0 ? std::abs(f_->slope + f_->curvature * time_) +
                        std::abs(f_->curvature) * span
                  : (n == 1 ? std::abs(f_->curvature) : 0));
      if (here > 0 && here >= span * next / (n + 1)) return true;
      if (here < -4e-16 * (n == 0 ? 0 : size_[n])) return false;
    }
    return false;
  }

  // True if the function certainly falls within the whole of `span`.
  bool Falls(double span) const {
    return derivative_[1] +
               span * (bound_[0][2] + bound_[1][2] + std::abs(f_->curvature)) <
           0;
  }

  // True if chord and curvature, or envelopes, prove the function positive
  // between this point and `end`, `span` later.
  bool ChordPositive(const Scan& end, double span) const {
    const double eighth = span * span / 8;
    const double bend = std::max(0.0, f_->curvature);
    const double low = std::min(value_, end.value_);
    if (low > eighth * (bend + bound_[0][2] + bound_[1][2])) return true;
    // The fast pair by its envelope, the rest by chord and curvature.
    const double fast =
        f_->pairs[1] == nullptr ? 0 : f_->pairs[1]->Bound(states_[1], span);
    const double rest =
        std::min(value_ - states_[1].value, end.value_ - end.states_[1].value);
    if (rest - fast > eighth * (bend + bound_[0][2])) return true;
    const double slow =
        f_->pairs[0] == nullptr ? 0 : f_->pairs[0]->Bound(states_[0], span);
    const double polynomial =
        std::min(value_ - states_[1].value - states_[0].value,
                 end.value_ - end.states_[1].value - end.states_[0].value);
    return polynomial - fast - slow > eighth * bend;
  }

  // This scan, `span` seconds later.
  Scan After(double span) const {
    Scan later = *this;
    later.time_ = time_ + span;
    later.value_ += span * (f_->slope + f_->curvature * (time_ + span / 2));
    for (int i = 0; i < 2; ++i) {
      if (f_->pairs[i] == nullptr) continue;
      const PairState change = f_->pairs[i]->Change(states_[i], span);
      later.value_ += change.value;
      later.states_[i].value += change.value;
      later.states_[i].rate += change.rate;
    }
    return later;
  }

  double Slope() const {
    double slope = f_->slope + f_->curvature * time_;
    for (int i = 0; i < 2; ++i) {
      if (f_->pairs[i] != nullptr) slope += states_[i].rate;
    }
    return slope;
  }

 private:
  const ModalFunction* f_;
  std::array<PairState, 2> states_;
  double time_ = 0;
  double value_;
  std::array<double, kDerivatives + 1> derivative_ = {};
  std::array<double, kDerivatives + 1> size_ = {};
  std::array<std::array<double, kDerivatives + 1>, 2> bound_ = {};
};

// The zero of a falling function between `begin`, where it is not negative,
// and `span` later, where it is not positive: Newton's method, kept inside
// the bracket.
double Refine(const Scan& begin, double span) {
  double low = 0;
  double high = span;
  Scan point = begin;
  double t = 0;
  for (int step = 0; step < 100; ++step) {
    const double slope = point.Slope();
    double next = slope < 0 ? t - point.value() / slope : high;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (next <= low || next >= high || std::abs(next - t) <= 2e-16 * next) {
      return next;
    }
    t = next;
    point = begin.After(t);
    if (point.value() > 0) {
      low = t;
    } else {
      high = t;
    }
  }
  return t;
}

}  // namespace

ModalFunction ModalFunction::Negated() const {
  ModalFunction negated = *this;
  negated.start = -start;
  negated.slope = -slope;
  negated.curvature = -curvature;
  for (PairState& state : negated.states) {
    state = {-state.value, -state.rate};
  }
  return negated;
}

double FirstCrossing(const ModalFunction& f, double horizon) {
  constexpr double kGrowth = 16;
  constexpr double kShrink = 4;
  Scan here(f);
  const double fastest = here.Fastest();
  const double first_step = fastest > 0 ? 0.5 / fastest : horizon;
  // Below this, a dip is rounding.
  const double smallest = 1e-9 * first_step;
  double time = 0;
  double step = first_step;
  while (time < horizon) {
    const double span = std::min(step, horizon - time);
    here.Differentiate(span);
    const Scan end = here.After(span);
    const bool positive = here.TaylorPositive(span) ||
                          (end.value() > 0 && here.ChordPositive(end, span));
    if (positive) {
      here = end;
      time += span;
      step = span * kGrowth;
    } else if (end.value() <= 0 && (here.Falls(span) || span < smallest)) {
      return time + Refine(here, span);
    } else if (span < smallest) {
      here = end;
      time += span;
      step = span * kGrowth;
    } else {
      step = span / kShrink;
    }
  }
  return horizon + 1;
}

}  // namespace tactus
