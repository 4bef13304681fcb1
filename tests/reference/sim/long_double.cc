#include "tests/reference/sim/long_double.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

using Real = long double;

constexpr Real kMaxSteps = 1e9L;

// Deformation, its rate, object position and speed, integral of the
// deformation while touching; then the constant 1 and the equilibrium point.
constexpr int kStates = 5;
constexpr int kInputs = 2;
constexpr int kSize = kStates + kInputs;
using Vector = std::array<Real, kSize>;
using Matrix = std::array<Vector, kSize>;

// What the equilibrium point does.
enum Motion { kAdvances, kRests, kRetreats };

struct Mode {
  bool touching = true;
  bool sliding = false;
  Motion motion = kAdvances;
};

Real SpeedOf(const ContactScene& s, Motion motion) {
  if (motion == kAdvances) return s.velocity_m_s;
  return motion == kRests ? 0 : -Real(s.retreat_speed_m_s);
}

Matrix Equations(const ContactScene& s, const Mode& mode) {
  const Real m = s.arm_mass_kg;
  const Real k = s.actuator_stiffness;
  const Real b = s.actuator_damping;
  const Real contact = mode.touching ? Real(s.object_stiffness) : 0;
  const Real speed = SpeedOf(s, mode.motion);
  Matrix a = {};
  a[0][1] = 1;
  // Arm: m (w + v)' = k (eq - x - d) + b (speed - v - w) - contact d.
  a[1][0] = -(k + contact) / m;
  a[1][1] = -b / m;
  a[1][2] = -k / m;
  a[1][3] = -b / m;
  a[1][5] = b * speed / m;
  a[1][6] = k / m;
  if (mode.sliding) {
    const Real mass = s.object_mass_kg;
    const Real friction = Real(s.mu_kinetic) * Real(kGravity);
    a[2][3] = 1;
    a[3][0] = contact / mass;
    a[3][5] = -friction;
    a[1][0] -= contact / mass;
    a[1][5] += friction;
  }
  if (mode.touching) a[4][0] = 1;
  a[6][5] = speed;
  return a;
}

// a x, without the entries that Equations() leaves zero.
Vector Times(const Matrix& a, const Vector& x) {
  Vector y = {};
  y[0] = a[0][1] * x[1];
  y[1] = a[1][0] * x[0] + a[1][1] * x[1] + a[1][2] * x[2] + a[1][3] * x[3] +
         a[1][5] * x[5] + a[1][6] * x[6];
  y[2] = a[2][3] * x[3];
  y[3] = a[3][0] * x[0] + a[3][5] * x[5];
  y[4] = a[4][0] * x[0];
  y[6] = a[6][5] * x[5];
  return y;
}

// exp(a t) x by its power series; |a| t is about 1.
Vector Propagate(const Matrix& a, const Vector& x, Real t) {
  Vector sum = x;
  Vector term = x;
  for (int n = 1; n <= 30; ++n) {
    term = Times(a, term);
    bool small = true;
    for (int i = 0; i < kSize; ++i) {
      term[i] *= t / n;
      sum[i] += term[i];
      small = small && std::abs(term[i]) <= 1e-21L * std::abs(sum[i]);
    }
    if (small) break;
  }
  return sum;
}

// A step of one length in one mode, ready made.
class Stepper {
 public:
  Stepper(const Matrix& a, Real step) {
    for (int j = 0; j < kSize; ++j) {
      Vector unit = {};
      unit[j] = 1;
      const Vector column = Propagate(a, unit, step);
      for (int i = 0; i < kSize; ++i) matrix_[i][j] = column[i];
    }
  }
  Vector Step(const Vector& x) const {
    Vector y = x;
    for (int i = 0; i < kStates; ++i) {
      y[i] = 0;
      for (int j = 0; j < kSize; ++j) y[i] += matrix_[i][j] * x[j];
    }
    y[6] = matrix_[6][5] * x[5] + x[6];
    return y;
  }

 private:
  Matrix matrix_;
};

// Two functions that must stay positive, and their rates.
struct Margin {
  Real value[2];
  Real rate[2];
};

Margin Margins(const ContactScene& s, const Mode& mode, const Matrix& a,
               const Vector& x) {
  Margin margin;
  const Real sign = mode.touching ? 1 : -1;
  margin.value[0] = sign * x[0];
  margin.rate[0] = sign * x[1];
  margin.value[1] = 1;
  margin.rate[1] = 0;
  if (mode.sliding) {
    margin.value[1] = x[3];
    margin.rate[1] = a[3][0] * x[0] + a[3][5];
  } else if (mode.touching && !s.fixed) {
    margin.value[1] = Real(s.mu_static) * s.object_mass_kg * Real(kGravity) /
                          s.object_stiffness -
                      x[0];
    margin.rate[1] = -x[1];
  }
  return margin;
}

// The time of the lowest point of a cubic with these ends, if it is inside.
Real LowestTime(Real f0, Real g0, Real f1, Real g1, Real h) {
  // Bisection on the cubic's rate, which changes its sign once.
  Real low = 0;
  Real high = 1;
  for (int i = 0; i < 50; ++i) {
    const Real u = (low + high) / 2;
    const Real rate = 6 * u * (u - 1) * (f0 - f1) / h +
                      (1 - u) * (1 - 3 * u) * g0 + u * (3 * u - 2) * g1;
    (rate < 0 ? low : high) = u;
  }
  return h * low;
}

class ReferenceRun {
 public:
  ReferenceRun(const ContactScene& scene, double rate, double step_share)
      : s_(scene), rate_(rate), step_share_(step_share) {}
  absl::StatusOr<Trajectory> Go();

 private:
  Real Crossing(int e, Real high) const;
  Real Event(const Vector& end, Real h, int* which) const;
  Real StepLength() const;
  void Switch(int which);
  void Advance(Real until);
  void Sample();
  // Changes to `motion` at `from`, once, if that is not beyond `until`.
  void Turn(Real from, Motion motion, Real until);

  const ContactScene& s_;
  const double rate_;
  const Real step_share_;
  Mode mode_;
  Matrix a_;
  Vector x_ = {};
  Real time_ = 0;
  Real contact_time_ = 0;
  // By mode.
  std::array<std::optional<Stepper>, 12> steppers_;
  Trajectory out_;
};

// The zero of margin `e` before `high`, where it is negative: Newton's method
// inside a bracket. It leaves zero upwards first, if it starts there.
Real ReferenceRun::Crossing(int e, Real high) const {
  Real low = 0;
  Real t = high;
  for (int i = 0; i < 200 && high - low > 1e-19L * high; ++i) {
    const Margin margin = Margins(s_, mode_, a_, Propagate(a_, x_, t));
    (margin.value[e] < 0 ? high : low) = t;
    Real next = t - margin.value[e] / margin.rate[e];
    if (!(margin.rate[e] < 0 && next > low && next < high)) {
      next = (low + high) / 2;
    }
    if (std::abs(next - t) <= 1e-19L * t) break;
    t = next;
  }
  return t;
}

// The time of the first event before `h`, where the state is `end`; else -1.
Real ReferenceRun::Event(const Vector& end, Real h, int* which) const {
  const Margin before = Margins(s_, mode_, a_, x_);
  const Margin after = Margins(s_, mode_, a_, end);
  Real first = -1;
  for (int e = 0; e < 2; ++e) {
    Real high = -1;
    if (after.value[e] < 0) {
      high = h;
    } else if (before.rate[e] < 0 && after.rate[e] > 0) {
      const Real low = LowestTime(before.value[e], before.rate[e],
                                  after.value[e], after.rate[e], h);
      const Vector x = Propagate(a_, x_, low);
      if (Margins(s_, mode_, a_, x).value[e] < 0) high = low;
    }
    if (high < 0) continue;
    high = Crossing(e, high);
    if (first < 0 || high < first) {
      first = high;
      *which = e;
    }
  }
  return first;
}

void ReferenceRun::Switch(int which) {
  if (which == 0) {
    x_[0] = 0;
    ++(mode_.touching ? out_.events.contacts_lost : out_.events.contacts_made);
    mode_.touching = !mode_.touching;
  } else {
    if (mode_.sliding) {
      x_[1] += x_[3];
      ++out_.events.stops;
    } else {
      ++out_.events.slips;
    }
    x_[3] = 0;
    mode_.sliding = !mode_.sliding;
  }
  a_ = Equations(s_, mode_);
}

Real ReferenceRun::StepLength() const {
  const Real mass = mode_.sliding ? s_.object_mass_kg : 1e300;
  const Real contact = mode_.touching ? s_.object_stiffness : 0;
  const Real fastest = std::sqrt(
      (s_.actuator_stiffness + contact) / s_.arm_mass_kg + contact / mass);
  const Real damping = s_.actuator_damping / s_.arm_mass_kg;
  return step_share_ / std::max(fastest, damping);
}

// Steps of one length, and the rest, to `until`, event by event.
void ReferenceRun::Advance(Real until) {
  while (time_ < until) {
    const Real length = StepLength();
    std::optional<Stepper>& stepper =
        steppers_[mode_.touching * 6 + mode_.sliding * 3 + mode_.motion];
    if (!stepper) stepper.emplace(a_, length);
    bool met = false;
    while (time_ < until && !met) {
      const Real left = until - time_;
      const Real h = std::min(left, length);
      const Vector end =
          left < length ? Propagate(a_, x_, h) : stepper->Step(x_);
      int which = 0;
      const Real at = Event(end, h, &which);
      met = at >= 0;
      x_ = met ? Propagate(a_, x_, at) : end;
      time_ = met ? time_ + at : (left <= length ? until : time_ + h);
      if (mode_.touching) contact_time_ += met ? at : h;
      if (met) Switch(which);
    }
  }
}

void ReferenceRun::Sample() {
  TrajectorySample sample;
  sample.x_arm = static_cast<double>(x_[2] + x_[0]);
  sample.v_arm = static_cast<double>(x_[3] + x_[1]);
  sample.x_uobj = static_cast<double>(x_[2]);
  sample.v_uobj = static_cast<double>(x_[3]);
  sample.force =
      mode_.touching
          ? std::max(0.0, static_cast<double>(s_.object_stiffness * x_[0]))
          : 0;
  sample.impulse = static_cast<double>(s_.object_stiffness * x_[4]);
  sample.contact_time = static_cast<double>(contact_time_);
  out_.samples.push_back(sample);
}

void ReferenceRun::Turn(Real from, Motion motion, Real until) {
  if (mode_.motion >= motion || from > until) return;
  Advance(from);
  mode_.motion = motion;
  if (motion == kRests) x_[6] = s_.goal_m;
  a_ = Equations(s_, mode_);
}

absl::StatusOr<Trajectory> ReferenceRun::Go() {
  TACTUS_RETURN_IF_ERROR(Validate(s_));
  const double fastest =
      std::sqrt(s_.object_stiffness *
                (1 / s_.arm_mass_kg + (s_.fixed ? 0 : 1 / s_.object_mass_kg)));
  if (fastest * s_.duration_s > kMaxSteps * step_share_) {
    return NumericalFailure("the reference would take more than 1e9 steps");
  }
  a_ = Equations(s_, mode_);
  x_[1] = s_.touch_speed_m_s;
  x_[5] = 1;
  x_[6] = s_.lead_m;
  out_.sample_rate_hz = rate_;
  out_.samples.emplace_back();
  out_.samples.back().v_arm = s_.touch_speed_m_s;
  const int samples =
      static_cast<int>(std::floor(s_.duration_s * rate_ + 1e-9));
  for (int n = 1; n <= samples; ++n) {
    const Real until = n / static_cast<Real>(rate_);
    const Real ramp_end = (Real(s_.goal_m) - s_.lead_m) / s_.velocity_m_s;
    if (ramp_end < s_.retreat_after_s) Turn(ramp_end, kRests, until);
    Turn(s_.retreat_after_s, kRetreats, until);
    Advance(until);
    Sample();
  }
  out_.moved = x_[2] > 0;
  return std::move(out_);
}

}  // namespace

absl::StatusOr<Trajectory> IntegrateReference(const ContactScene& scene,
                                              double sample_rate_hz,
                                              double step_share) {
  return ReferenceRun(scene, sample_rate_hz, step_share).Go();
}

}  // namespace tactus::internal
