#include "core/sim/coupled/coupled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/sim/coupled/coupled_equations.h"
#include "core/sim/model/equilibrium.h"

namespace tactus::internal {
namespace {

constexpr double kStepShare = 0.7;
// Terms of a step's power series: 0.7^20 / 20! is beyond rounding.
constexpr int kTerms = 20;
constexpr int kMost = limits::kMaxSceneObjects;
// A step may be this share longer than its matrix says.
constexpr double kSlack = 1e-9;

// Above what a few operations round off, as a share.
constexpr double kRounding = 1e-14;

// The motion of one step as a power series in the share of the step.
using StepSeries = std::array<CoupledState, kTerms + 1>;
using Polynomial = std::array<double, kTerms + 1>;

StepSeries SeriesOf(const CoupledMatrix& a, const CoupledState& x, double h) {
  StepSeries series;
  series[0] = x;
  for (int n = 1; n <= kTerms; ++n) {
    series[n].noalias() = a * series[n - 1];
    series[n] *= h / n;
  }
  return series;
}

CoupledState At(const StepSeries& series, double share) {
  CoupledState x = series[kTerms];
  for (int n = kTerms - 1; n >= 0; --n) x = x * share + series[n];
  return x;
}

double At(const Polynomial& p, double share) {
  double y = p[kTerms];
  for (int n = kTerms - 1; n >= 0; --n) y = y * share + p[n];
  return y;
}

double SlopeAt(const Polynomial& p, double share) {
  double y = kTerms * p[kTerms];
  for (int n = kTerms - 1; n >= 1; --n) y = y * share + n * p[n];
  return y;
}

// Where p falls through zero before `high`, where it is negative: Newton's
// method inside a bracket.
double Crossing(const Polynomial& p, double high) {
  double low = 0;
  double share = high;
  for (int i = 0; i < 200 && high - low > 1e-17; ++i) {
    const double value = At(p, share);
    (value < 0 ? high : low) = share;
    const double slope = SlopeAt(p, share);
    double next = share - value / slope;
    if (!(slope < 0 && next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - share) <= 1e-16 * share) break;
    share = next;
  }
  return share;
}

// Where p, which falls at 0 and rises at 1, is lowest.
double Lowest(const Polynomial& p) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (SlopeAt(p, middle) < 0 ? low : high) = middle;
  }
  return low;
}

enum class Ending { kContact, kFriction };

// Stays positive until an event: offset + sign * state[place].
struct Margin {
  double offset = 0;
  double sign = 0;  // 0: no such event
  int place = 0;

  double ValueAt(const CoupledState& x) const {
    return offset + sign * x[place];
  }
};

// What one combination of phases needs, ready made.
struct Mode {
  CoupledMatrix a;
  // The state after `step_s`.
  CoupledMatrix step;
  double step_s = 0;
  std::array<std::array<Margin, 2>, kMost> margins;
};

// The first event of a step.
struct Event {
  double share = 2;  // beyond 1: none
  int object = 0;
  Ending ending = Ending::kContact;
};

class CoupledRun {
 public:
  CoupledRun(const CoupledScene& scene, const CoupledOptions& options)
      : scene_(scene),
        options_(options),
        count_(static_cast<int>(scene.objects.size())) {}
  absl::StatusOr<std::vector<Trajectory>> Go();

 private:
  Margin MarginOf(int object, Ending ending) const;
  // Looks up the mode of phases_, or makes it.
  void EnterMode();
  absl::Status Advance(double until);
  absl::Status StepTo(double target);
  // Finds the first event of the step from x_ to `end` of `h` seconds.
  Event FindEvent(const CoupledState& end, double h) const;
  void Switch(const Event& event);
  void Sample();
  double Displacement(int object) const;

  const CoupledScene& scene_;
  const CoupledOptions& options_;
  const int count_;
  CoupledPhases phases_ = {};
  double speed_ = 0;  // of the equilibrium point
  std::map<int, Mode> modes_;
  const Mode* mode_ = nullptr;
  CoupledState x_ = CoupledState::Zero();
  double time_ = 0;
  int64_t steps_ = 0;
  int64_t events_ = 0;
  std::array<double, kMost> contact_time_ = {};
  // Where objects at rest are, m from where they lay.
  std::array<double, kMost> rest_ = {};
  std::vector<Trajectory> out_;
};

Margin CoupledRun::MarginOf(int i, Ending ending) const {
  const CoupledObject& object = scene_.objects[i];
  const ContactPhase phase = phases_[i];
  if (ending == Ending::kContact) {
    return {.sign = Touching(phase) ? 1.0 : -1.0, .place = DeformationOf(i)};
  }
  if (Sliding(phase)) return {.sign = 1, .place = SpeedOf(i)};
  if (!Touching(phase) || object.fixed) return {};
  return {.offset = object.StaticLimit() / object.stiffness,
          .sign = -1,
          .place = DeformationOf(i)};
}

void CoupledRun::EnterMode() {
  int code = 0;
  for (int i = 0; i < count_; ++i) {
    code = 4 * code + static_cast<int>(phases_[i]);
  }
  const auto [found, fresh] = modes_.try_emplace(code);
  Mode& mode = found->second;
  mode_ = &mode;
  if (!fresh) return;
  mode.a = CoupledEquations(scene_, phases_, speed_);
  // Whole steps from sample to sample.
  const double interval = 1 / options_.sample_rate_hz;
  mode.step_s = interval /
                std::ceil(interval * FastestRate(scene_, phases_) / kStepShare);
  for (int j = 0; j < kCoupledStates; ++j) {
    mode.step.col(j) =
        At(SeriesOf(mode.a, CoupledState::Unit(j), mode.step_s), 1);
  }
  for (int i = 0; i < count_; ++i) {
    mode.margins[i] = {MarginOf(i, Ending::kContact),
                       MarginOf(i, Ending::kFriction)};
  }
}

Event CoupledRun::FindEvent(const CoupledState& end, double h) const {
  const CoupledState before = mode_->a * x_;
  const CoupledState after = mode_->a * end;
  Event first;
  StepSeries series;
  bool solved = false;
  for (int i = 0; i < count_; ++i) {
    for (const Ending ending : {Ending::kContact, Ending::kFriction}) {
      const Margin& margin = mode_->margins[i][static_cast<int>(ending)];
      if (margin.sign == 0) continue;
      const double value = margin.ValueAt(x_);
      const bool falls = margin.sign * before[margin.place] < 0;
      const bool below = margin.ValueAt(end) < 0;
      const bool dips = falls && margin.sign * after[margin.place] > 0;
      if (!below && !dips && !(value < 0 && falls)) continue;
      double share = 0;
      if (!(value < 0 && falls)) {
        if (!solved) series = SeriesOf(mode_->a, x_, h);
        solved = true;
        Polynomial p;
        for (int n = 0; n <= kTerms; ++n) {
          p[n] = margin.sign * series[n][margin.place];
        }
        p[0] += margin.offset;
        const double high = below ? 1 : Lowest(p);
        if (!below && At(p, high) >= 0) continue;
        share = Crossing(p, high);
      }
      if (share < first.share) first = {share, i, ending};
    }
  }
  return first;
}

// Exactly on the event, so that the next phase starts clean.
void CoupledRun::Switch(const Event& event) {
  const int i = event.object;
  bool touching = Touching(phases_[i]);
  bool sliding = Sliding(phases_[i]);
  EventCounts& events = out_[i].events;
  if (event.ending == Ending::kContact) {
    x_[DeformationOf(i)] = 0;
    ++(touching ? events.contacts_lost : events.contacts_made);
    touching = !touching;
  } else {
    if (sliding) {
      rest_[i] = Displacement(i);
      ++events.stops;
    } else {
      // Above the friction while sliding, or rounding would stop it at once.
      const double least =
          scene_.objects[i].KineticFriction() / scene_.objects[i].stiffness;
      x_[DeformationOf(i)] =
          std::max(x_[DeformationOf(i)], (1 + kRounding) * least);
      ++events.slips;
    }
    x_[SpeedOf(i)] = 0;
    sliding = !sliding;
  }
  phases_[i] = touching
                   ? (sliding ? ContactPhase::kSliding : ContactPhase::kStuck)
                   : (sliding ? ContactPhase::kCoasting : ContactPhase::kApart);
  ++events_;
  EnterMode();
}

double CoupledRun::Displacement(int i) const {
  return Sliding(phases_[i]) ? x_[kCoupledArm] - x_[DeformationOf(i)] -
                                   scene_.objects[i].distance_m
                             : rest_[i];
}

absl::Status CoupledRun::StepTo(double target) {
  while (time_ < target) {
    const double left = target - time_;
    const bool whole = left >= mode_->step_s * (1 - kSlack);
    const bool last = left <= mode_->step_s * (1 + kSlack);
    const double h = whole ? mode_->step_s : left;
    CoupledState end;
    if (whole) {
      end.noalias() = mode_->step * x_;
    } else {
      end = At(SeriesOf(mode_->a, x_, h), 1);
    }
    const Event event = FindEvent(end, h);
    const bool met = event.share <= 1;
    const double passed = met ? event.share * h : h;
    for (int i = 0; i < count_; ++i) {
      if (Touching(phases_[i])) contact_time_[i] += passed;
    }
    x_ = met ? At(SeriesOf(mode_->a, x_, h), event.share) : end;
    time_ = last && !met ? target : std::min(target, time_ + passed);
    if (met) Switch(event);
    if (++steps_ > options_.max_steps || events_ > options_.max_events) {
      return NumericalFailure(absl::StrCat(
          "more than ", options_.max_steps, " steps or ", options_.max_events,
          " events before ", time_, " s of the simulated contacts"));
    }
  }
  return absl::OkStatus();
}

void CoupledRun::Sample() {
  for (int i = 0; i < count_; ++i) {
    const double stiffness = scene_.objects[i].stiffness;
    TrajectorySample sample;
    sample.x_arm = x_[kCoupledArm];
    sample.v_arm = x_[kCoupledArmSpeed];
    sample.x_uobj = Displacement(i);
    sample.v_uobj = x_[SpeedOf(i)];
    if (Touching(phases_[i])) {
      sample.force = std::max(0.0, stiffness * x_[DeformationOf(i)]);
    }
    sample.impulse = stiffness * x_[IntegralOf(i)];
    sample.contact_time = contact_time_[i];
    out_[i].samples.push_back(sample);
  }
}

absl::Status CoupledRun::Advance(double until) {
  while (time_ < until) {
    const double due = static_cast<double>(out_.front().samples.size()) /
                       options_.sample_rate_hz;
    TACTUS_RETURN_IF_ERROR(StepTo(std::min(until, due)));
    if (due <= until) Sample();
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Trajectory>> CoupledRun::Go() {
  out_.resize(count_);
  x_[kCoupledOne] = 1;
  x_[kCoupledArmSpeed] = scene_.arm.touch_speed_m_s;
  for (int i = 0; i < count_; ++i) {
    out_[i].sample_rate_hz = options_.sample_rate_hz;
    const double distance = scene_.objects[i].distance_m;
    x_[DeformationOf(i)] = -distance;
    phases_[i] = distance > 0 ? ContactPhase::kApart : ContactPhase::kStuck;
  }
  Sample();
  for (const EquilibriumLeg& leg : EquilibriumLegs(scene_.arm)) {
    const double until = std::min(leg.end_s, scene_.arm.duration_s);
    if (time_ >= until) continue;
    speed_ = leg.speed_m_s;
    x_[kCoupledEquilibrium] = leg.PositionAt(time_);
    modes_.clear();
    EnterMode();
    TACTUS_RETURN_IF_ERROR(Advance(until));
  }
  if (!x_.allFinite()) {
    return NumericalFailure("the simulated contacts are not finite");
  }
  // The last sample may lie a rounding beyond the last step.
  const auto due = static_cast<size_t>(
      std::floor(scene_.arm.duration_s * options_.sample_rate_hz + 1e-9));
  if (out_.front().samples.size() <= due) Sample();
  for (int i = 0; i < count_; ++i) out_[i].moved = Displacement(i) > 0;
  return std::move(out_);
}

absl::Status Validate(const CoupledOptions& options) {
  const double rate = options.sample_rate_hz;
  if (rate >= 500 && rate <= limits::kMaxTrajectoryRateHz &&
      std::fmod(rate, 100) == 0) {
    return absl::OkStatus();
  }
  return InvalidScene("coupled.sample_rate_hz", rate,
                      absl::StrCat("a multiple of 100 from 500 to ",
                                   limits::kMaxTrajectoryRateHz));
}

}  // namespace

absl::StatusOr<std::vector<Trajectory>> IntegrateCoupled(
    const CoupledScene& scene, const CoupledOptions& options) {
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  TACTUS_RETURN_IF_ERROR(Validate(options));
  return CoupledRun(scene, options).Go();
}

}  // namespace tactus::internal
