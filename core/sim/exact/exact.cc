#include "core/sim/exact/exact.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/bounce_ride.h"
#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/first_crossing.h"
#include "core/sim/model/equilibrium.h"

namespace tactus::internal {
namespace {

enum class Ending { kHorizon, kContact, kFriction };

struct PieceEnd {
  double time = 0;  // s into the piece
  Ending ending = Ending::kHorizon;
};

// Contact lost or made, whichever comes from this phase, before `horizon`.
double ContactChange(const ContactPiece& piece, double horizon) {
  const ModalFunction deformation = piece.Deformation();
  return FirstCrossing(
      Touching(piece.phase()) ? deformation : deformation.Negated(), horizon);
}

// Slip or stop before `horizon`.
double FrictionChange(const ContactScene& scene, const ContactPiece& piece,
                      double horizon) {
  switch (piece.phase()) {
    case ContactPhase::kStuck: {
      if (scene.fixed) return horizon + 1;
      ModalFunction margin = piece.Deformation().Negated();
      margin.start =
          scene.StaticLimit() / piece.stiffness() - piece.start().deformation;
      return FirstCrossing(margin, horizon);
    }
    case ContactPhase::kSliding:
      // The contact only pushes: friction alone stops the object no sooner.
      if (piece.start().speed > scene.mu_kinetic * kGravity * horizon) break;
      return FirstCrossing(piece.ObjectSpeed(), horizon);
    case ContactPhase::kCoasting:
      return piece.start().speed / (scene.mu_kinetic * kGravity);
    case ContactPhase::kApart:
      break;
  }
  return horizon + 1;
}

PieceEnd FindEnd(const ContactScene& scene, const ContactPiece& piece,
                 double horizon) {
  PieceEnd end = {horizon, Ending::kHorizon};
  const double contact = ContactChange(piece, end.time);
  if (contact < end.time) end = {contact, Ending::kContact};
  const double friction = FrictionChange(scene, piece, end.time);
  if (friction <= end.time) end = {friction, Ending::kFriction};
  return end;
}

// The phase after `ending`, and its state: exactly on the event, so that it
// starts clean.
PhaseStart Follow(const ContactScene& scene, const ContactPiece& piece,
                  const PieceEnd& end, EventCounts& events) {
  const ContactPhase phase = piece.phase();
  bool touching = Touching(phase);
  bool sliding = Sliding(phase);
  PieceState state = piece.At(end.time);
  if (end.ending == Ending::kContact) {
    state.deformation = 0;
    ++(touching ? events.contacts_lost : events.contacts_made);
    touching = !touching;
  } else if (end.ending == Ending::kFriction) {
    if (sliding) {
      // The arm keeps its speed.
      state.approach += state.speed;
      ++events.stops;
    } else {
      state.deformation = scene.StaticLimit() / piece.stiffness();
      ++events.slips;
    }
    state.speed = 0;
    sliding = !sliding;
  }
  return {touching ? (sliding ? ContactPhase::kSliding : ContactPhase::kStuck)
                   : (sliding ? ContactPhase::kCoasting : ContactPhase::kApart),
          state};
}

bool Finite(const PieceState& state) {
  return std::isfinite(state.deformation + state.approach + state.position +
                       state.speed);
}

// Takes samples at a fixed rate from pieces.
class Sampler : public PieceSink {
 public:
  Sampler(const ContactScene& scene, const ExactOptions& options)
      : rate_(options.sample_rate_hz), stiffness_(scene.object_stiffness) {
    trajectory_.sample_rate_hz = rate_;
    due_ = 1 + static_cast<size_t>(std::floor(scene.duration_s * rate_ + 1e-9));
    trajectory_.samples.reserve(due_);
    trajectory_.samples.emplace_back();
    trajectory_.samples.back().v_arm = scene.touch_speed_m_s;
  }

  BounceDetail detail() const override { return BounceDetail::kInstant; }

  double NextSample() const override {
    return static_cast<double>(trajectory_.samples.size()) / rate_;
  }

  void TakeTotals(double impulse, double contact_time) override {
    impulse_ += impulse;
    contact_time_ += contact_time;
  }

  void TakeSample(const PieceState& state, double impulse,
                  double contact_time) override {
    TakeTotals(impulse, contact_time);
    Append(state, stiffness_);
  }

  void Take(const ContactPiece& piece, double duration) override {
    const bool touching = Touching(piece.phase());
    while (trajectory_.samples.size() < due_) {
      const double t = NextSample() - piece.begin();
      if (t > duration) break;
      Append(piece.At(t), piece.stiffness());
      trajectory_.samples.back().impulse += piece.Impulse(t);
      if (touching) trajectory_.samples.back().contact_time += t;
    }
    impulse_ += piece.Impulse(duration);
    if (touching) contact_time_ += duration;
  }

  // The last sample may lie a rounding beyond the last piece.
  Trajectory Finish(const PieceSummary& summary) {
    while (trajectory_.samples.size() < due_) {
      trajectory_.samples.push_back(trajectory_.samples.back());
    }
    trajectory_.moved = summary.moved;
    trajectory_.events = summary.events;
    return std::move(trajectory_);
  }

 private:
  void Append(const PieceState& state, double stiffness) {
    TrajectorySample sample;
    sample.x_arm = state.arm_position();
    sample.v_arm = state.arm_speed();
    sample.x_uobj = state.position;
    sample.v_uobj = state.speed;
    sample.force = std::max(0.0, stiffness * state.deformation);
    sample.impulse = impulse_;
    sample.contact_time = contact_time_;
    trajectory_.samples.push_back(sample);
  }

  double rate_;
  double stiffness_;
  size_t due_ = 0;
  double impulse_ = 0;       // of finished pieces
  double contact_time_ = 0;  // of finished pieces
  Trajectory trajectory_;
};

}  // namespace

absl::Status Validate(const ExactOptions& options) {
  if (!(options.skip_tolerance >= 0 && options.skip_tolerance <= 0.1)) {
    return InvalidScene("exact.skip_tolerance", options.skip_tolerance,
                        "0 to 0.1");
  }
  const double rate = options.sample_rate_hz;
  if (!(rate >= 500 && rate <= limits::kMaxTrajectoryRateHz)) {
    return InvalidScene("exact.sample_rate_hz", rate,
                        absl::StrCat("500 to ", limits::kMaxTrajectoryRateHz));
  }
  if (std::fmod(rate, 100) != 0) {
    return InvalidScene("exact.sample_rate_hz", rate, "a multiple of 100");
  }
  return absl::OkStatus();
}

absl::StatusOr<PieceSummary> SolvePieces(const ContactScene& scene,
                                         const ExactOptions& options,
                                         PieceSink& sink) {
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  TACTUS_RETURN_IF_ERROR(Validate(options));
  const ContactModes modes(scene);
  PieceSummary summary;
  PhaseStart next;
  next.state.approach = scene.touch_speed_m_s;
  const std::vector<EquilibriumLeg> legs = EquilibriumLegs(scene);
  auto leg = legs.begin();
  double time = 0;
  while (time < scene.duration_s) {
    const double until = std::min(leg->end_s, scene.duration_s);
    const ContactPiece piece(scene, modes, next.phase, *leg, time, next.state);
    const PieceEnd end = FindEnd(scene, piece, until - time);
    sink.Take(piece, end.time);
    next = Follow(scene, piece, end, summary.events);
    if (!Finite(next.state)) {
      return NumericalFailure("the simulated contact is not finite");
    }
    if (end.ending == Ending::kHorizon) {
      time = until;
      // The last leg never ends before the scene does.
      if (std::next(leg) != legs.end()) ++leg;
    } else {
      time = std::min(time + end.time, until);
    }
    if (end.ending == Ending::kContact && Sliding(next.phase)) {
      const BounceRide ride = {&scene,
                               &modes,
                               &*leg,
                               until,
                               options.skip_tolerance,
                               options.max_events};
      time = RideBounces(ride, time, sink, next, summary);
    }
    ++summary.solved;
    if (summary.solved > options.max_events) {
      return NumericalFailure(absl::StrCat(
          "more than ", options.max_events, " bounces to solve before ", time,
          " s of the simulated contact (exact.max_events)"));
    }
  }
  summary.moved = next.state.position > 0;
  return summary;
}

absl::StatusOr<Trajectory> IntegrateExact(const ContactScene& scene,
                                          const ExactOptions& options) {
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  TACTUS_RETURN_IF_ERROR(Validate(options));
  Sampler sampler(scene, options);
  TACTUS_ASSIGN_OR_RETURN(const PieceSummary summary,
                          SolvePieces(scene, options, sampler));
  return sampler.Finish(summary);
}

}  // namespace tactus::internal
