#include "core/sim/exact/contact_piece.h"

#include <algorithm>

namespace tactus::internal {
namespace {

struct Split {
  PairState slow;
  PairState fast;
};

// Splits a solution of the fourth-order equation, given by its value and
// first three derivatives, into its slow and its fast pair.
Split SplitModes(const ContactModes& modes, double value, double rate,
                 double second, double third) {
  const double p1 = modes.slow.damping();
  const double q1 = modes.slow.stiffness();
  const double p2 = modes.fast.damping();
  const double q2 = modes.fast.stiffness();
  // The slow operator leaves of the fast part alone
  // (p1 - p2) fast' + (q1 - q2) fast; solve that and its rate for fast.
  const double left = second + p1 * rate + q1 * value;
  const double left_rate = third + p1 * second + q1 * rate;
  const double p = p1 - p2;
  const double q = q1 - q2;
  const double corner = q - p2 * p;
  const double determinant = q * corner + p * q2 * p;
  Split split;
  split.fast.value = (corner * left - p * left_rate) / determinant;
  split.fast.rate = (q * left_rate + q2 * p * left) / determinant;
  split.slow.value = value - split.fast.value;
  split.slow.rate = rate - split.fast.rate;
  return split;
}

PairState Scaled(const PairState& state, double factor) {
  return {factor * state.value, factor * state.rate};
}

}  // namespace

ContactPiece::ContactPiece(const ContactScene& scene, const ContactModes& modes,
                           ContactPhase phase, const EquilibriumLeg& leg,
                           double begin, const PieceState& start)
    : scene_(&scene),
      modes_(&modes),
      phase_(phase),
      begin_(begin),
      start_(start),
      equilibrium_speed_(leg.speed_m_s),
      pair_(&modes.arm) {
  const double equilibrium = leg.PositionAt(begin);
  const double k = scene.actuator_stiffness;
  const double stiffness = modes.stiffness;
  switch (phase) {
    case ContactPhase::kStuck: {
      pair_ = &modes.stuck;
      drift_ = k * equilibrium_speed_ / (k + stiffness);
      const double rest =
          (k * (equilibrium - start.position) +
           scene.actuator_damping * (equilibrium_speed_ - drift_)) /
          (k + stiffness);
      main_ = {start.deformation - rest, start.approach - drift_};
      break;
    }
    case ContactPhase::kSliding: {
      pair_ = &modes.slow;
      compliance_ = scene.object_mass_kg / stiffness;
      const double friction = scene.KineticFriction();
      const double compressed = friction / stiffness;
      const Split split = SplitModes(
          modes, start.position - (equilibrium - friction / k - compressed),
          start.speed - equilibrium_speed_,
          (start.deformation - compressed) / compliance_,
          start.approach / compliance_);
      main_ = split.slow;
      ringing_ = split.fast;
      break;
    }
    case ContactPhase::kCoasting:
    case ContactPhase::kApart:
      main_ = {start.arm_position() - equilibrium,
               start.arm_speed() - equilibrium_speed_};
      break;
  }
}

PieceState ContactPiece::At(double t) const {
  PieceState state = start_;
  const PairState main = pair_->Change(main_, t);
  switch (phase_) {
    case ContactPhase::kStuck:
      state.deformation += drift_ * t + main.value;
      state.approach += main.rate;
      break;
    case ContactPhase::kSliding: {
      const PairState ringing = modes_->fast.Change(ringing_, t);
      const PairState slow = Curvature(*pair_, main);
      const PairState fast = Curvature(modes_->fast, ringing);
      state.deformation += compliance_ * (slow.value + fast.value);
      state.approach += compliance_ * (slow.rate + fast.rate);
      state.position += equilibrium_speed_ * t + main.value + ringing.value;
      state.speed += main.rate + ringing.rate;
      break;
    }
    case ContactPhase::kCoasting: {
      const double slowing = scene_->mu_kinetic * kGravity * t;
      const double moved = (start_.speed - slowing / 2) * t;
      state.position += moved;
      state.speed -= slowing;
      state.deformation +=
          (start_.approach - main_.rate + slowing / 2) * t + main.value;
      state.approach += main.rate + slowing;
      break;
    }
    case ContactPhase::kApart:
      state.deformation += (start_.approach - main_.rate) * t + main.value;
      state.approach += main.rate;
      break;
  }
  return state;
}

PieceState ContactPiece::WithoutRinging() const {
  PieceState state = start_;
  const PairState bend = Curvature(modes_->fast, ringing_);
  state.deformation -= compliance_ * bend.value;
  state.approach -= compliance_ * bend.rate;
  state.position -= ringing_.value;
  state.speed -= ringing_.rate;
  return state;
}

double ContactPiece::Impulse(double t) const {
  switch (phase_) {
    case ContactPhase::kStuck:
      return modes_->stiffness *
             ((start_.deformation - main_.value + drift_ / 2 * t) * t +
              pair_->Integral(main_, t));
    case ContactPhase::kSliding:
      return scene_->object_mass_kg * (pair_->Change(main_, t).rate +
                                       modes_->fast.Change(ringing_, t).rate +
                                       scene_->mu_kinetic * kGravity * t);
    case ContactPhase::kCoasting:
    case ContactPhase::kApart:
      break;
  }
  return 0;
}

std::array<const DampedPair*, 2> ContactPiece::pairs() const {
  return {pair_, phase_ == ContactPhase::kSliding ? &modes_->fast : nullptr};
}

PieceForm ContactPiece::Force() const {
  PieceForm form;
  if (phase_ == ContactPhase::kStuck) {
    form.constant = modes_->stiffness * (start_.deformation - main_.value);
    form.slope = modes_->stiffness * drift_;
    form.value[0] = modes_->stiffness;
  } else if (phase_ == ContactPhase::kSliding) {
    // The object's inertia and friction, which need no small deformation.
    form.constant = scene_->KineticFriction();
    const auto both = pairs();
    for (int i = 0; i < 2; ++i) {
      form.value[i] = -scene_->object_mass_kg * both[i]->stiffness();
      form.rate[i] = -scene_->object_mass_kg * both[i]->damping();
    }
  }
  return form;
}

PieceForm ContactPiece::ArmPosition() const {
  PieceForm form;
  form.value[0] = 1;
  form.constant = start_.arm_position() - main_.value;
  form.slope = equilibrium_speed_;
  if (phase_ == ContactPhase::kStuck) {
    form.slope = drift_;
  } else if (phase_ == ContactPhase::kSliding) {
    const std::array<PairState, 2> state = states();
    const auto both = pairs();
    form.constant = start_.arm_position();
    for (int i = 0; i < 2; ++i) {
      form.value[i] = 1 - compliance_ * both[i]->stiffness();
      form.rate[i] = -compliance_ * both[i]->damping();
      form.constant -=
          form.value[i] * state[i].value + form.rate[i] * state[i].rate;
    }
  }
  return form;
}

PieceForm ContactPiece::ObjectPosition() const {
  PieceForm form;
  form.constant = start_.position;
  if (phase_ == ContactPhase::kSliding) {
    form.constant -= main_.value + ringing_.value;
    form.slope = equilibrium_speed_;
    form.value = {1, 1};
  }
  return form;
}

ModalFunction ContactPiece::Deformation() const {
  ModalFunction f;
  f.start = start_.deformation;
  f.pairs[0] = pair_;
  f.states[0] = main_;
  switch (phase_) {
    case ContactPhase::kStuck:
      f.slope = drift_;
      break;
    case ContactPhase::kSliding:
      f.states[0] = Scaled(Curvature(*pair_, main_), compliance_);
      f.pairs[1] = &modes_->fast;
      f.states[1] = Scaled(Curvature(modes_->fast, ringing_), compliance_);
      break;
    case ContactPhase::kCoasting:
      f.curvature = scene_->mu_kinetic * kGravity;
      [[fallthrough]];
    case ContactPhase::kApart:
      f.slope = start_.approach - main_.rate;
      break;
  }
  return f;
}

ModalFunction ContactPiece::ObjectSpeed() const {
  ModalFunction f;
  f.start = start_.speed;
  if (phase_ == ContactPhase::kSliding) {
    f.pairs = {pair_, &modes_->fast};
    f.states = {pair_->Derivative(main_), modes_->fast.Derivative(ringing_)};
  } else if (phase_ == ContactPhase::kCoasting) {
    f.slope = -scene_->mu_kinetic * kGravity;
  }
  return f;
}

}  // namespace tactus::internal
