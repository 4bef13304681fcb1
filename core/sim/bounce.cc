#include "core/sim/bounce.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus {
namespace {

using std::numbers::pi;

// Slow motion spans at most this share of its own time scale in one piece:
// five terms of its series are then exact to double precision.
constexpr double kSlowSpan = 2e-3;
// The ringing loses at most this share in one contact.
constexpr double kRingLoss = 1e-3;
// Turns of the ringing's angle by more than this are computed afresh.
constexpr double kSmallTurn = 0.03;

// The first derivatives of a solution of y'' + p y' + q y = 0.
struct Series {
  Series(const DampedPair& pair, double value, double rate) {
    y[0] = value;
    y[1] = rate;
    for (int n = 2; n < 7; ++n) {
      y[n] = -pair.damping() * y[n - 1] - pair.stiffness() * y[n - 2];
    }
  }
  // Change of derivative `n` after `t`, by four terms.
  double Change(int n, double t) const {
    return t * (y[n + 1] +
                t / 2 * (y[n + 2] + t / 3 * (y[n + 3] + t / 4 * y[n + 4])));
  }
  double y[7];
};

}  // namespace

BounceTrain::BounceTrain(const ContactScene& scene, const ContactModes& modes,
                         bool ramping, double time, ContactPhase phase,
                         const ContactState& state)
    : scene_(&scene),
      modes_(&modes),
      touching_(Touching(phase)),
      time_(time),
      equilibrium_speed_(ramping ? scene.velocity_m_s : 0),
      equilibrium_start_(ramping ? 0 : scene.goal_m),
      friction_(scene.mu_kinetic * kGravity),
      compliance_(scene.object_mass_kg / modes.stiffness),
      offset_(scene.KineticFriction() / scene.actuator_stiffness +
              scene.KineticFriction() / modes.stiffness) {
  at_.lag = state.position - (equilibrium_start_ + equilibrium_speed_ * time);
  at_.rate = state.arm_speed() - equilibrium_speed_;
  at_.approach = state.approach;
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
  decay_ = fast.damping() / 2;
  frequency_ =
      std::sqrt(std::max(0.0, fast.stiffness() - decay_ * decay_));
  slowest_span_ = kSlowSpan / std::max(modes.arm.fastest(), slow.fastest());
}

ContactState BounceTrain::state() const {
  ContactState state;
  state.approach = at_.approach;
  state.position =
      equilibrium_start_ + equilibrium_speed_ * time_ + at_.lag;
  state.speed = at_.rate + equilibrium_speed_ - at_.approach;
  return state;
}

std::optional<double> BounceTrain::Next(double until, double* impulse) {
  Surface after = at_;
  *impulse = 0;
  const std::optional<double> span =
      touching_ ? Press(after, impulse) : Fly(after);
  if (!span || !(time_ + *span < until)) return std::nullopt;
  at_ = after;
  time_ += *span;
  touching_ = !touching_;
  return span;
}

// d(t) = approach t + (a + friction) t^2 / 2 + a' t^3 / 6 + ..., where a is
// the arm's acceleration. It bends upwards throughout, so that the root
// beyond 0 is the only one.
std::optional<double> BounceTrain::Fly(Surface& at) const {
  const Series arm(modes_->arm, at.lag, at.rate);
  const double gravity = arm.y[2] + friction_;
  if (!(at.approach < 0 && gravity > 0)) return std::nullopt;
  const double guess = -2 * at.approach / gravity;
  if (!(guess < slowest_span_) ||
      !(gravity > 8 * guess * std::abs(arm.y[3]) +
                      8 * guess * guess * std::abs(arm.y[4]))) {
    return std::nullopt;
  }
  double t = guess;
  double bend = 0;
  for (int step = 0; step < 4; ++step) {
    bend = arm.y[3] / 6 + t * (arm.y[4] / 24 + t * arm.y[5] / 120);
    const double next =
        -at.approach / (gravity / 2 + t * bend);
    const bool settled = std::abs(next - t) <= 1e-15 * t;
    t = next;
    if (settled) break;
  }
  const double speed = at.rate + equilibrium_speed_ - at.approach;
  if (!(speed > 1.01 * friction_ * t)) return std::nullopt;
  const double change = arm.Change(1, t);
  at.lag += arm.Change(0, t);
  at.rate += change;
  at.approach += friction_ * t + change;
  if (!(at.approach > 0)) return std::nullopt;
  return t;
}

// Turns the remembered angle a little.
void BounceTrain::Turn(double angle) {
  angle_ += angle;
  if (std::abs(angle) > kSmallTurn) {
    cosine_ = std::cos(angle_);
    sine_ = std::sin(angle_);
    return;
  }
  const double square = angle * angle;
  const double sine =
      angle * (1 - square / 6 * (1 - square / 20 * (1 - square / 42)));
  const double less =
      square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
  const double cosine = cosine_ - (cosine_ * less + sine_ * sine);
  sine_ += cosine_ * sine - sine_ * less;
  cosine_ = cosine;
}

// d(t) = slow part + ringing. With a slow part that hardly changes and hardly
// any damping, d starts at 0 with a positive rate and its next zero is the
// only one before a full turn of the ringing.
std::optional<double> BounceTrain::Press(Surface& at, double* impulse) {
  if (!(frequency_ > 0) || !(at.approach > 0)) return std::nullopt;
  const double turn = 2 * pi / frequency_;
  if (!(turn < slowest_span_ && turn * decay_ < kRingLoss)) {
    return std::nullopt;
  }
  const DampedPair& fast_pair = modes_->fast;
  // The object's position and its first three derivatives, less its
  // particular solution, split into slow and fast.
  const double p1 = modes_->slow.damping();
  const double q1 = modes_->slow.stiffness();
  const double value = at.lag + offset_;
  const double rate = at.rate - at.approach;
  const double third = at.approach / compliance_;
  const double left = -friction_ + p1 * rate + q1 * value;
  const double left_rate = third - p1 * friction_ + q1 * rate;
  const Series slow(modes_->slow,
                    value - (fast_[0][0] * left + fast_[0][1] * left_rate),
                    rate - (fast_[1][0] * left + fast_[1][1] * left_rate));
  // Deformation: compliance (friction + slow'') + ringing.
  const double rest = friction_ + slow.y[2];
  const double ring = -compliance_ * rest;
  const double ring_rate = at.approach - compliance_ * slow.y[3];
  if (!(rest > 0) || !(ring_rate > -0.05 * ring * frequency_) ||
      !(std::abs(slow.y[3]) * turn < 0.01 * rest)) {
    return std::nullopt;
  }
  const double mixed = (ring_rate + decay_ * ring) / frequency_;
  const double back =
      (fast_pair.stiffness() * ring + decay_ * ring_rate) / frequency_;
  if (angle_ == 0) {
    Turn(2 * (pi - std::atan(mixed / -ring)));
  }
  double t = 0;
  double slow_change = 0;
  double slow_rate = 0;
  double envelope = 1;
  double ringing = 0;
  double ringing_rate = 0;
  bool settled = false;
  for (int step = 0; step < 6 && !settled; ++step) {
    t = angle_ / frequency_;
    slow_change = slow.Change(2, t);
    slow_rate = slow.y[3] + slow.Change(3, t);
    const double x = decay_ * t;
    envelope = 1 - x * (1 - x / 2 * (1 - x / 3 * (1 - x / 4)));
    ringing = envelope * (ring * cosine_ + mixed * sine_);
    ringing_rate = envelope * (ring_rate * cosine_ - back * sine_);
    const double d = compliance_ * (rest + slow_change) + ringing;
    const double d_rate = compliance_ * slow_rate + ringing_rate;
    const double turned = -frequency_ * d / d_rate;
    settled = std::abs(turned) < 1e-13;
    if (settled) break;
    if (!(std::abs(turned) < 1)) break;
    Turn(turned);
  }
  t = angle_ / frequency_;
  if (!settled || !(angle_ > 0.98 * pi && angle_ < 1.99 * pi)) {
    angle_ = 0;
    cosine_ = 1;
    sine_ = 0;
    return std::nullopt;
  }
  const double speed = rate + equilibrium_speed_;
  if (!(speed > 1.01 * friction_ * t)) return std::nullopt;
  const double approach = compliance_ * slow_rate + ringing_rate;
  // The fast pair of the position from that of the deformation.
  const double second = ringing / compliance_;
  const double fast_rate = -(ringing_rate / compliance_ +
                             fast_pair.damping() * second) /
                           fast_pair.stiffness();
  const double fast =
      -(second + fast_pair.damping() * fast_rate) / fast_pair.stiffness();
  const double new_rate = slow.y[1] + slow.Change(1, t) + fast_rate;
  if (!(approach < 0)) return std::nullopt;
  at.lag = slow.y[0] + slow.Change(0, t) + fast - offset_;
  at.rate = new_rate + approach;
  at.approach = approach;
  *impulse = scene_->object_mass_kg * (new_rate - rate + friction_ * t);
  return t;
}

}  // namespace tactus
