#include "core/sim/exact/bounce.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tactus::internal {
namespace {

using std::numbers::pi;

// A piece may span at most this fraction of the slow motion's time scale. Then
// the given number of terms of its series is exact to double precision.
constexpr double kShortSpan = 2e-3;
constexpr int kShortTerms = 4;
constexpr double kLongSpan = 0.125;
constexpr int kLongTerms = 10;
// The ringing loses at most this fraction of its amplitude in one contact.
constexpr double kRingLoss = 5e-3;
// Turns of the ringing's angle by more than this are computed afresh.
constexpr double kSmallTurn = 0.03;

constexpr std::array<double, kLongTerms + 3> kBounceInverse = [] {
  std::array<double, kLongTerms + 3> inverse = {};
  for (size_t n = 1; n < inverse.size(); ++n) inverse[n] = 1.0 / n;
  return inverse;
}();

// The derivatives 0 to kTerms + kHighest of a solution of y'' + p y' + q y = 0.
template <int kTerms, int kHighest>
struct Series {
  Series(const DampedPair& pair, double value, double rate) {
    y[0] = value;
    y[1] = rate;
    for (int n = 2; n <= kTerms + kHighest; ++n) {
      y[n] = -pair.damping() * y[n - 1] - pair.stiffness() * y[n - 2];
    }
  }
  // Change of derivative `n` <= kHighest after `t`.
  double Change(int n, double t) const {
    double sum = y[n + kTerms];
    for (int k = kTerms; k > 1; --k) {
      sum = y[n + k - 1] + kBounceInverse[k] * t * sum;
    }
    return t * sum;
  }
  double y[kTerms + kHighest + 1];
};

// 1 - exp(-x) for 0 <= x <= 2 kRingLoss.
double Faded(double x) {
  double sum = 1;
  for (int n = 7; n > 1; --n) sum = 1 - kBounceInverse[n] * x * sum;
  return x * sum;
}

}  // namespace

BounceTrain::BounceTrain(const ContactScene& scene, const ContactModes& modes,
                         const EquilibriumLeg& leg)
    : modes_(&modes),
      leg_(leg),
      friction_(scene.mu_kinetic * kGravity),
      compliance_(scene.object_mass_kg / modes.stiffness),
      rigidity_(modes.stiffness / scene.object_mass_kg),
      offset_(scene.KineticFriction() / scene.actuator_stiffness +
              scene.KineticFriction() / modes.stiffness),
      softness_(1 / modes.fast.stiffness()),
      decay_(modes.fast.damping() / 2) {
  const DampedPair& slow = modes.slow;
  const DampedPair& fast = modes.fast;
  const double p = slow.damping() - fast.damping();
  const double q = slow.stiffness() - fast.stiffness();
  const double corner = q - fast.damping() * p;
  const double determinant = q * corner + p * fast.stiffness() * p;
  fast_[0][0] = corner / determinant;
  fast_[0][1] = -p / determinant;
  fast_[1][0] = fast.stiffness() * p / determinant;
  fast_[1][1] = q / determinant;
  frequency_ = std::sqrt(std::max(0.0, fast.stiffness() - decay_ * decay_));
  period_ = 1 / frequency_;
  const double fastest = std::max(modes.arm.fastest(), slow.fastest());
  short_span_ = kShortSpan / fastest;
  long_span_ = kLongSpan / fastest;
}

BounceMoment BounceTrain::MomentOf(ContactPhase phase, double time,
                                   const PieceState& state) const {
  BounceMoment moment;
  moment.time = time;
  moment.lag = state.position - leg_.PositionAt(time);
  moment.rate = state.arm_speed() - leg_.speed_m_s;
  moment.approach = state.approach;
  moment.touching = Touching(phase);
  return moment;
}

PieceState BounceTrain::StateOf(const BounceMoment& moment) const {
  PieceState state;
  state.approach = moment.approach;
  state.position = leg_.PositionAt(moment.time) + moment.lag;
  state.speed = moment.rate + leg_.speed_m_s - moment.approach;
  return state;
}

double BounceTrain::Next(double until, BounceMoment& moment) {
  BounceMoment next = moment;
  const double span = next.touching ? Press(next) : Fly(next);
  next.time += span;
  if (!(span > 0 && next.time < until)) return 0;
  next.touching = !next.touching;
  moment = next;
  return span;
}

double BounceTrain::Fly(BounceMoment& moment) const {
  const double gravity =
      modes_->arm.Derivative({moment.lag, moment.rate}).rate + friction_;
  const double guess = -2 * moment.approach / gravity;
  if (!(gravity > 0 && guess > 0 && guess < long_span_)) return 0;
  return guess < short_span_ ? FlyBy<kShortTerms>(moment, guess)
                             : FlyBy<kLongTerms>(moment, guess);
}

// d(t) = approach t + (a + friction) t^2 / 2 + a' t^3 / 6 + ..., where a is
// the arm's acceleration. It bends upwards throughout, so that the root
// beyond 0 is the only one.
template <int kTerms>
double BounceTrain::FlyBy(BounceMoment& moment, double t) const {
  const Series<kTerms, 1> arm(modes_->arm, moment.lag, moment.rate);
  const double gravity = arm.y[2] + friction_;
  // Four times the change of gravity in this time stays below it.
  if (!(gravity > 8 * t * (std::abs(arm.y[3]) + t * std::abs(arm.y[4])))) {
    return 0;
  }
  // Newton's method for d(t) / t.
  for (int step = 0; step < 6; ++step) {
    // d(t) / t - approach, by t, and its rate.
    double value = kBounceInverse[kTerms + 1] * arm.y[kTerms + 1];
    double slope = 0;
    for (int k = kTerms; k >= 2; --k) {
      const double term = k == 2 ? gravity : arm.y[k];
      slope = (slope * t + value) * kBounceInverse[k];
      value = (value * t + term) * kBounceInverse[k];
    }
    slope = slope * t + value;
    const double correction = (moment.approach + value * t) / slope;
    t -= correction;
    if (std::abs(correction) < 1e-8 * t) break;
  }
  const double speed = moment.rate + leg_.speed_m_s - moment.approach;
  if (!(speed > 1.01 * friction_ * t)) return 0;
  // It comes back as fast as it left, but for the change of gravity. So little
  // is rounded here: in 10^5 bounces a bias of one part in 10^16 would count.
  double gain = 0;
  for (int k = kTerms + 1; k > 2; --k) {
    gain = t * kBounceInverse[k] * ((k - 2) * arm.y[k] + gain);
  }
  moment.lag += arm.Change(0, t);
  moment.rate += arm.Change(1, t);
  moment.approach = t / 2 * gain - moment.approach;
  return moment.approach > 0 ? t : 0;
}

void BounceTrain::Turn(double angle) {
  angle_ += angle;
  if (std::abs(angle) > kSmallTurn) {
    cosine_ = std::cos(angle_);
    sine_ = std::sin(angle_);
    return;
  }
  const double square = angle * angle;
  const double sine =
      angle * (1 - square * (1.0 / 6) * (1 - square * (1.0 / 20)));
  const double less =
      0.5 * square * (1 - square * (1.0 / 12) * (1 - square * (1.0 / 30)));
  const double cosine = cosine_ - (cosine_ * less + sine_ * sine);
  sine_ += cosine_ * sine - sine_ * less;
  cosine_ = cosine;
  // Keeps them on the unit circle: over many bounces a drift would feed the
  // ringing.
  const double excess = 0.5 * (cosine_ * cosine_ + sine_ * sine_ - 1);
  cosine_ -= excess * cosine_;
  sine_ -= excess * sine_;
}

double BounceTrain::Press(BounceMoment& moment) {
  const double turn = 2 * pi * period_;
  if (!(turn < long_span_ && turn * decay_ < kRingLoss)) return 0;
  return turn < short_span_ ? PressBy<kShortTerms>(moment)
                            : PressBy<kLongTerms>(moment);
}

// d(t) = slow part + ringing. With a slow part that hardly changes and hardly
// any damping, d starts at 0 with a positive rate and its next zero is the
// only one before a full turn of the ringing.
template <int kTerms>
double BounceTrain::PressBy(BounceMoment& moment) {
  const double turn = 2 * pi * period_;
  const DampedPair& fast_pair = modes_->fast;
  // The object's position and its first three derivatives, less its
  // particular solution, split into slow and fast.
  const double p1 = modes_->slow.damping();
  const double q1 = modes_->slow.stiffness();
  const double value = moment.lag + offset_;
  const double rate = moment.rate - moment.approach;
  const double third = moment.approach * rigidity_;
  const double left = -friction_ + p1 * rate + q1 * value;
  const double left_rate = third - p1 * friction_ + q1 * rate;
  const Series<kTerms, 3> slow(
      modes_->slow, value - (fast_[0][0] * left + fast_[0][1] * left_rate),
      rate - (fast_[1][0] * left + fast_[1][1] * left_rate));
  // Deformation: compliance (friction + slow'') + ringing.
  const double rest = friction_ + slow.y[2];
  const double ring = -compliance_ * rest;
  const double ring_rate = moment.approach - compliance_ * slow.y[3];
  const double speed = rate + leg_.speed_m_s;
  if (!(rest > 0 && ring_rate > -0.05 * ring * frequency_ &&
        (std::abs(slow.y[3]) + std::abs(slow.y[4]) * turn) * turn <
            0.01 * rest &&
        speed > 1.01 * friction_ * turn)) {
    return 0;
  }
  const double mixed = (ring_rate + decay_ * ring) * period_;
  const double back =
      (fast_pair.stiffness() * ring + decay_ * ring_rate) * period_;
  const double before = angle_;
  if (before == 0) {
    Turn(2 * (pi - std::atan(-mixed / ring)));
  } else {
    Turn(drift_);
  }
  bool found = false;
  for (int step = 0; step < 8; ++step) {
    const double t = angle_ * period_;
    const double envelope = 1 - Faded(decay_ * t);
    const double ringing = envelope * (ring * cosine_ + mixed * sine_);
    const double ringing_rate = envelope * (ring_rate * cosine_ - back * sine_);
    const double rise_rate = compliance_ * slow.Change(3, t);
    double approach = compliance_ * slow.y[3] + rise_rate + ringing_rate;
    if (found) {
      drift_ = before == 0 ? 0 : angle_ - before;
      if (!(angle_ > 0.98 * pi && angle_ < 1.99 * pi && approach < 0)) break;
      // The same with little rounded, as in flight: where the ringing r is
      // w = r' + decay r, w^2 + frequency^2 r^2 fades by exp(-2 decay t).
      const double rise = compliance_ * slow.Change(2, t);
      const double twice = rise - 2 * ring;
      const double w = mixed * frequency_;
      const double lost = Faded(2 * decay_ * t);
      const double change = -lost - frequency_ * frequency_ *
                                        (lost * ring * ring + rise * twice) /
                                        (w * w);
      approach = 2 * compliance_ * slow.y[3] + rise_rate + decay_ * twice -
                 w * change / (1 + std::sqrt(1 + change)) - moment.approach;
      // The fast pair of the position from that of the deformation.
      const double second = ringing * rigidity_;
      const double fast_rate =
          -(ringing_rate * rigidity_ + fast_pair.damping() * second) *
          softness_;
      const double fast =
          -(second + fast_pair.damping() * fast_rate) * softness_;
      const double new_rate = slow.y[1] + slow.Change(1, t) + fast_rate;
      moment.lag = slow.y[0] + slow.Change(0, t) + fast - offset_;
      moment.rate = new_rate + approach;
      moment.approach = approach;
      return t;
    }
    const double deformation =
        compliance_ * (rest + slow.Change(2, t)) + ringing;
    const double missed = -frequency_ * deformation / approach;
    if (!(std::abs(missed) < 1)) break;
    Turn(missed);
    // Newton's method squares this.
    found = std::abs(missed) < 1e-8;
  }
  angle_ = 0;
  drift_ = 0;
  cosine_ = 1;
  sine_ = 0;
  return 0;
}

}  // namespace tactus::internal
