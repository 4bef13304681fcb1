#include "core/sim/exact/first_crossing.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

// Rounding error of a derivative, as a fraction of its terms.
constexpr double kCrossingRounding = 4e-16;

// By powers of time.
using CrossingQuartic = std::array<double, 5>;

// A time up to which `c`, positive at once, is certainly positive; about that
// of its first root, at least, if one is near `scale`.
double PositiveSpan(CrossingQuartic c, double scale) {
  int first = 0;
  while (c[first] == 0) ++first;
  if (first < 3 && c[first + 1] < 0 && c[first + 2] > 0) {
    // A dip that a parabola proves harmless.
    const double low =
        c[first] - c[first + 1] * c[first + 1] / (4 * c[first + 2]);
    if (low > 0) {
      c[first] = low;
      c[first + 1] = 0;
      c[first + 2] = 0;
    }
  }
  // Behind the first negative term no positive ones: what is left has one root.
  bool negative = false;
  for (int n = first + 1; n <= 4; ++n) {
    if (negative) c[n] = std::min(c[n], 0.0);
    negative = negative || c[n] < 0;
  }
  if (!negative) return 1e300;
  double low = 0;
  double high = 1e300;
  double t = scale;
  for (int step = 0; step < 60 && low < 0.9 * high; ++step) {
    double value = 0;
    double slope = 0;
    for (int n = 4; n >= first; --n) {
      slope = slope * t + value;
      value = value * t + c[n];
    }
    (value > 0 ? low : high) = t;
    double next = slope < 0 ? t - value / slope : 4 * t;
    // A little short of the root is as good, and certain.
    if (next > 0.97 * t && next < high) next *= 0.97;
    if (!(next > low && next < high)) {
      next = high < 1e300 ? low + (high - low) / 2 : 4 * t;
    }
    t = next;
  }
  return low;
}

// The function seen from one point: its state there, its derivatives and a
// bound on the fourth from there on.
class Scan {
 public:
  explicit Scan(const ModalFunction& f)
      : f_(&f), states_(f.states), value_(f.start) {}

  double value() const { return value_; }

  double Slope() const {
    double slope = f_->slope + f_->curvature * time_;
    for (int i = 0; i < 2; ++i) {
      if (f_->pairs[i] != nullptr) slope += states_[i].rate;
    }
    return slope;
  }

  double Fastest() const {
    double rate = 0;
    for (const DampedPair* pair : f_->pairs) {
      if (pair != nullptr) rate = std::max(rate, pair->fastest());
    }
    return rate;
  }

  // Finds the derivatives, and the bound for the next `span` seconds.
  void Differentiate(double span) {
    derivative_ = {value_, f_->slope + f_->curvature * time_, f_->curvature, 0};
    size_ = {0, std::abs(derivative_[1]), std::abs(derivative_[2]), 0};
    fourth_ = 0;
    for (int i = 0; i < 2; ++i) {
      if (f_->pairs[i] == nullptr) continue;
      PairState state = states_[i];
      for (int n = 1; n <= 3; ++n) {
        state = f_->pairs[i]->Derivative(state);
        derivative_[n] += state.value;
        size_[n] += std::abs(state.value);
      }
      fourth_ += f_->pairs[i]->Bound(f_->pairs[i]->Derivative(state), span);
    }
  }

  // The rest need Differentiate() first.

  // True if the function is at zero, or beyond, and falls.
  bool Crosses() const {
    for (int n = 0; n < 4; ++n) {
      if (derivative_[n] > kCrossingRounding * size_[n]) return false;
      if (n > 0 && derivative_[n] < -kCrossingRounding * size_[n]) return true;
    }
    return false;
  }

  // A time within which the function is certainly positive.
  double SafeSpan(double scale) const {
    CrossingQuartic c = {derivative_[0], derivative_[1], derivative_[2] / 2,
                         derivative_[3] / 6, -fourth_ / 24};
    for (int n = 0; n < 4; ++n) {
      if (c[n] > kCrossingRounding * size_[n]) return PositiveSpan(c, scale);
      c[n] = 0;
    }
    return fourth_ > 0 ? 0 : 1e300;
  }

  // A time by which the function certainly falls through zero, throughout; 0
  // if there is none.
  double FallingSpan() const {
    if (!(derivative_[1] < 0)) return 0;
    const double span = -1.5 * value_ / derivative_[1];
    const double bend = std::abs(derivative_[2]) +
                        span * (std::abs(derivative_[3]) + span / 2 * fourth_);
    return bend * span * span < value_ && bend * span < -derivative_[1] ? span
                                                                        : 0;
  }

  // False if envelopes do not even prove the function positive here.
  bool Clear(double span) const {
    double rest = value_;
    for (int i = 1; i >= 0; --i) {
      if (f_->pairs[i] == nullptr) continue;
      rest -= states_[i].value + f_->pairs[i]->Bound(states_[i], span);
      if (rest > 0) return true;
    }
    return rest > 0;
  }

  // True if chord and curvature, or envelopes, prove the function positive
  // between this point and `end`, `span` later.
  bool ChordPositive(const Scan& end, double span) const {
    const double eighth = span * span / 8;
    const double bend = std::max(0.0, f_->curvature);
    // The fast pair by its envelope, the rest by chord and curvature.
    const double fast =
        f_->pairs[1] == nullptr ? 0 : f_->pairs[1]->Bound(states_[1], span);
    const double rest =
        std::min(value_ - states_[1].value, end.value_ - end.states_[1].value);
    if (rest - fast > eighth * (bend + SlowBend(span))) return true;
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

 private:
  double SlowBend(double span) const {
    if (f_->pairs[0] == nullptr) return 0;
    const DampedPair& pair = *f_->pairs[0];
    return pair.Bound(pair.Derivative(pair.Derivative(states_[0])), span);
  }

  const ModalFunction* f_;
  std::array<PairState, 2> states_;
  double time_ = 0;
  double value_;
  std::array<double, 4> derivative_ = {};
  std::array<double, 4> size_ = {};
  double fourth_ = 0;
};

// The zero of a function that falls through it within `span`: Newton's method.
double FallsAt(const Scan& begin, double span) {
  double t = span / 1.5;
  for (int step = 0; step < 8; ++step) {
    const Scan point = begin.After(t);
    const double correction = point.value() / point.Slope();
    t = std::clamp(t - correction, 0.0, span);
    if (std::abs(correction) < 1e-8 * span) break;
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
  Scan here(f);
  const double fastest = here.Fastest();
  const double scale = fastest > 0 ? 2 / fastest : horizon;
  // Below this, a dip is rounding.
  const double smallest = 1e-9 * scale;
  double time = 0;
  double leap = kGrowth * scale;
  while (time < horizon) {
    const double left = horizon - time;
    here.Differentiate(left);
    if (here.value() <= 0 && here.Crosses()) return time;
    const double falling = here.FallingSpan();
    if (falling > 0) {
      const double crossing = time + FallsAt(here, falling);
      return crossing <= horizon ? crossing : horizon + 1;
    }
    const double safe = here.SafeSpan(scale);
    if (safe >= left) break;
    if (leap > safe && here.Clear(left)) {
      const double span = std::min(leap, left);
      const Scan end = here.After(span);
      if (end.value() > 0 && here.ChordPositive(end, span)) {
        here = end;
        time += span;
        leap *= kGrowth;
        continue;
      }
      leap /= kGrowth;
    }
    const double span = std::min(std::max(safe, smallest), left);
    here = here.After(span);
    time += span;
    leap = std::max(leap, 2 * span);
  }
  return horizon + 1;
}

}  // namespace tactus::internal
