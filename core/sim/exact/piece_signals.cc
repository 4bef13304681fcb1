#include "core/sim/exact/piece_signals.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

constexpr double kInterval = 1 / kSignalRateHz;
constexpr double kFrame = 1 / kSkinRateHz;
// Boundaries may lie a rounding beyond the piece that ends there, s.
constexpr double kSlack = 1e-12;
// Longer than any contact, s.
constexpr double kForever = 1e3;
// What pairs that have faded may still add, as a fraction of the signal.
constexpr double kFaded = 1e-14;
// A pair that fades by less than e to this in a frame was not much larger
// before, beside what the filter has forgotten of it.
constexpr double kSteadyFading = 1;
constexpr int kSteadyFrames = 18;
// Limit of the area's error: the square of the part of the strain that comes
// from the pairs.
constexpr double kLinear = 1e-12;
// Share by which the thickness may change in half a frame, for its powers
// beyond kRampPowers to be lost beside 1.
constexpr double kSlowRamp = 0.01;

double Dot(const std::array<double, 2>& row, const PairState& state) {
  return row[0] * state.value + row[1] * state.rate;
}

void AddPair(const PairState& state,
             const std::array<BlockFilter::Column, 2>& columns,
             BlockFilter::Column& to) {
  Add(state.value, columns[0], to);
  Add(state.rate, columns[1], to);
}

}  // namespace

PieceSignals::PieceSignals(const Cube& cube, const ContactScene& scene,
                           bool area)
    : filter_(BlockFilter::AntiAlias()),
      cube_(cube),
      with_area_(area),
      full_area_(cube.edge_m * cube.edge_m),
      strain_per_newton_(1 / (cube.Stiffness() * cube.edge_m)) {
  const int frames =
      static_cast<int>(std::floor(scene.duration_s * kSkinRateHz + 1e-9));
  intervals_ = frames * kFilterBlock;
  signals_.samples.reserve(frames);
  signals_.object_motion.reserve(frames);
}

double PieceSignals::Area(double share, double force) {
  if (!with_area_ || share <= 0) return 0;
  const double strain = std::max(0.0, force / share) * strain_per_newton_;
  clamped_ |= strain > kMaxStrain;
  return share * full_area_ *
         std::pow(1 - std::min(strain, kMaxStrain),
                  -2 * cube_.material.poisson_ratio);
}

BlockFilter::Inputs PieceSignals::Areas(const BlockFilter::Inputs& forces) {
  // (1 - strain)^-n by its binomial series around the middle of the frame.
  const double exponent = 2 * cube_.material.poisson_ratio;
  const double middle =
      1 - std::clamp(forces[kFilterBlock / 2] * strain_per_newton_, 0.0,
                     kMaxStrain);
  BlockFilter::Inputs areas;
  double farthest = 0;
  double largest = 0;
  for (int j = 0; j < kFilterBlock; ++j) {
    const double strain = std::max(0.0, forces[j]) * strain_per_newton_;
    areas[j] = (strain - (1 - middle)) / middle;
    farthest = std::max(farthest, std::abs(areas[j]));
    largest = std::max(largest, strain);
  }
  if (largest > kMaxStrain || farthest > 0.03) {
    for (int j = 0; j < kFilterBlock; ++j) areas[j] = Area(1, forces[j]);
    return areas;
  }
  constexpr int kTerms = 12;
  std::array<double, kTerms + 1> terms = {1};
  int last = 0;
  for (double power = 1; last < kTerms && power > 1e-18; power *= farthest) {
    ++last;
    terms[last] = terms[last - 1] * (exponent + last - 1) / last;
  }
  const double scale = full_area_ * std::pow(middle, -exponent);
  BlockFilter::Inputs sums;
  sums.fill(terms[last]);
  for (int n = last - 1; n >= 0; --n) {
    for (int j = 0; j < kFilterBlock; ++j)
      sums[j] = sums[j] * areas[j] + terms[n];
  }
  for (int j = 0; j < kFilterBlock; ++j) areas[j] = scale * sums[j];
  return areas;
}

bool PieceSignals::Settled(const PieceForm& form, const FrameStart& start) {
  if (form.slope != 0) return false;
  const double negligible = kFaded * std::abs(form.constant);
  for (int i = 0; i < start.used; ++i) {
    const DampedPair& pair = *start.pairs[i];
    const PairState& state = start.states[i];
    if (std::abs(form.value[i]) * pair.Bound(state, kForever) > negligible ||
        std::abs(form.rate[i]) * pair.Bound(pair.Derivative(state), kForever) >
            negligible) {
      return false;
    }
  }
  return true;
}

void PieceSignals::FillTable(const ContactPiece& piece, PhaseTable& table) {
  table.ready = true;
  const PieceForm force = piece.Force();
  const PieceForm motion = piece.ArmPosition();
  const auto pairs = piece.pairs();
  for (int i = 0; i < 2; ++i) {
    if (pairs[i] == nullptr) continue;
    for (int from = 0; from < 2; ++from) {
      BlockFilter::Inputs forces;
      BlockFilter::Inputs motions;
      PairState state = {from == 0 ? 1.0 : 0.0, from == 0 ? 0.0 : 1.0};
      for (int j = 0; j < kFilterBlock; ++j) {
        const PairState change = pairs[i]->Change(state, kInterval);
        forces[j] = (force.value[i] * pairs[i]->Integral(state, kInterval) +
                     force.rate[i] * change.value) /
                    kInterval;
        state = {state.value + change.value, state.rate + change.rate};
        motions[j] = Dot({motion.value[i], motion.rate[i]}, state);
      }
      PairTable& pair = table.pairs[i];
      pair.frame[0][from] = state.value;
      pair.frame[1][from] = state.rate;
      pair.force[from] = forces;
      pair.drive.force[from] = filter_.Drive(forces);
      pair.drive.motion[from] = filter_.Drive(motions);
    }
    FillSteady(*pairs[i], table.pairs[i], table.steady);
  }
}

// What frames ago a pair put into the filter, in terms of its state now.
void PieceSignals::FillSteady(const DampedPair& pair, PairTable& table,
                              bool& steady) const {
  steady = steady && pair.FastestDecay() * kFrame < kSteadyFading;
  if (!steady) return;
  const auto& f = table.frame;
  const double determinant = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  const std::array<std::array<double, 2>, 2> back = {
      {{f[1][1] / determinant, -f[0][1] / determinant},
       {-f[1][0] / determinant, f[0][0] / determinant}}};
  for (int from = 0; from < 2; ++from) {
    std::array<PairState, kSteadyFrames> states;
    PairState state = {from == 0 ? 1.0 : 0.0, from == 0 ? 0.0 : 1.0};
    for (PairState& earlier : states) {
      earlier = state;
      state = {Dot(back[0], state), Dot(back[1], state)};
    }
    BlockFilter::Column& force = table.steady.force[from];
    BlockFilter::Column& motion = table.steady.motion[from];
    for (int n = kSteadyFrames - 1; n >= 0; --n) {
      force = filter_.Advance(force, {});
      motion = filter_.Advance(motion, {});
      AddPair(states[n], table.drive.force, force);
      AddPair(states[n], table.drive.motion, motion);
    }
  }
}

void PieceSignals::TakeArea(const PieceForm& force, const FrameStart& start,
                            const PhaseTable& table,
                            const BlockFilter::Column& pair_column,
                            bool steady) {
  double bound = 0;
  for (int i = 0; i < start.used; ++i) {
    const DampedPair& pair = *start.pairs[i];
    bound += std::abs(force.value[i]) * pair.Bound(start.states[i], kFrame) +
             std::abs(force.rate[i]) *
                 pair.Bound(pair.Derivative(start.states[i]), kFrame);
  }
  // A ramp's binomial series is one of constant columns; beside it, pairs
  // that have all but faded are linear.
  const double exponent = 2 * cube_.material.poisson_ratio;
  const double step = force.slope * kInterval;
  const double middle =
      1 - strain_per_newton_ * (start.force + (kFilterBlock - 1) / 2.0 * step);
  const double ramp = strain_per_newton_ * (kFilterBlock / 2.0) * step / middle;
  const double pairs = strain_per_newton_ * bound / middle;
  const double varies = std::abs(ramp) + pairs;
  if (middle * (1 - varies) > 1 - kMaxStrain && std::abs(ramp) < kSlowRamp &&
      pairs * varies < kLinear) {
    BlockFilter::Column column = {};
    const double scale = full_area_ * std::pow(middle, -exponent);
    double term = scale;
    for (int n = 0; n < kRampPowers && std::abs(term) > 1e-17 * scale; ++n) {
      Add(term, steady ? filter_.steady_power(n) : filter_.ramp_power(n),
          column);
      term *= ramp * (exponent + n) / (n + 1);
    }
    Add(scale * exponent * strain_per_newton_ / middle, pair_column, column);
    area_state_ = steady ? column : filter_.Advance(area_state_, column);
    return;
  }
  BlockFilter::Inputs forces;
  for (int j = 0; j < kFilterBlock; ++j) {
    forces[j] = start.force + force.slope * kInterval * j;
  }
  for (int i = 0; i < start.used; ++i) {
    const auto& rows = table.pairs[i].force;
    const PairState& state = start.states[i];
    for (int j = 0; j < kFilterBlock; ++j) {
      forces[j] += state.value * rows[0][j] + state.rate * rows[1][j];
    }
  }
  area_state_ = filter_.Step(area_state_, Areas(forces));
}

void PieceSignals::TakeFrames(const ContactPiece& piece, double end) {
  const bool touching = Touching(piece.phase());
  PhaseTable& table = tables_[static_cast<int>(piece.phase())];
  if (!table.ready) FillTable(piece, table);
  const PieceForm force = piece.Force();
  const PieceForm motion = piece.ArmPosition();
  const PieceForm object = piece.ObjectPosition();
  FrameStart start = {piece.pairs(), piece.states()};
  start.used = start.pairs[1] == nullptr ? 1 : 2;
  double time = Boundary(closed_) - piece.begin();
  for (int i = 0; i < start.used; ++i) {
    start.states[i] = start.pairs[i]->After(start.states[i], time);
  }
  int taken = 0;
  // Frames since the input of the filter stopped changing.
  int settled = 0;
  bool last_clamped = false;
  while (closed_ + kFilterBlock <= intervals_ &&
         Boundary(closed_ + kFilterBlock) <= end) {
    if (settled >= kSettlingBlocks) {
      signals_.samples.push_back(signals_.samples.back());
      signals_.object_motion.push_back(signals_.object_motion.back());
      signals_.clamped += last_clamped;
      closed_ += kFilterBlock;
      continue;
    }
    time = Boundary(closed_) - piece.begin();
    start.force = force.constant + force.slope * (time + kInterval / 2);
    // The filter knows nothing but this piece.
    const bool steady = table.steady && taken >= kSettlingBlocks;
    BlockFilter::Column force_column = {};
    BlockFilter::Column motion_column = {};
    for (int i = 0; i < start.used; ++i) {
      const PairTable& pair = table.pairs[i];
      const PairColumns& columns = steady ? pair.steady : pair.drive;
      if (touching) AddPair(start.states[i], columns.force, force_column);
      AddPair(start.states[i], columns.motion, motion_column);
    }
    if (with_area_ && touching) {
      TakeArea(force, start, table, force_column, steady);
    } else if (with_area_) {
      area_state_ = filter_.Advance(area_state_, {});
    }
    const BlockFilter::Column& constant =
        steady ? filter_.steady_constant() : filter_.constant();
    const BlockFilter::Column& ramp =
        steady ? filter_.steady_ramp() : filter_.ramp();
    Add(start.force, constant, force_column);
    Add(force.slope * kInterval, ramp, force_column);
    Add(motion.constant + motion.slope * (time + kInterval), constant,
        motion_column);
    Add(motion.slope * kInterval, ramp, motion_column);
    force_state_ =
        steady ? force_column : filter_.Advance(force_state_, force_column);
    motion_state_ =
        steady ? motion_column : filter_.Advance(motion_state_, motion_column);
    ++taken;
    last_clamped = clamped_;

    for (int i = 0; i < start.used; ++i) {
      const auto& frame = table.pairs[i].frame;
      start.states[i] = {Dot(frame[0], start.states[i]),
                         Dot(frame[1], start.states[i])};
    }
    closed_ += kFilterBlock;
    const bool rests = Settled(force, start) && Settled(motion, start) &&
                       !Sliding(piece.phase());
    settled = rests ? settled + 1 : 0;
    time = Boundary(closed_) - piece.begin();
    const double position = piece.phase() == ContactPhase::kCoasting
                                ? piece.At(time).position
                                : object.constant + object.slope * time +
                                      object.value[0] * start.states[0].value +
                                      object.value[1] * start.states[1].value;
    CloseFrame(position);
  }
}

void PieceSignals::CloseInterval(double impulse, double contact, double arm,
                                 double object) {
  const int j = closed_ % kFilterBlock;
  force_[j] = impulse * kSignalRateHz;
  area_[j] = Area(contact * kSignalRateHz, force_[j]);
  motion_[j] = arm;
  impulse_ = 0;
  contact_ = 0;
  ++closed_;
  if (j == kFilterBlock - 1) {
    force_state_ = filter_.Step(force_state_, force_);
    if (with_area_) area_state_ = filter_.Step(area_state_, area_);
    motion_state_ = filter_.Step(motion_state_, motion_);
    CloseFrame(object);
  }
}

void PieceSignals::CloseFrame(double object) {
  signals_.samples.push_back({BlockFilter::Output(force_state_),
                              BlockFilter::Output(area_state_),
                              BlockFilter::Output(motion_state_)});
  signals_.object_motion.push_back(object);
  signals_.clamped += clamped_;
  clamped_ = false;
}

void PieceSignals::TakeSample(const PieceState& state, double impulse,
                              double contact_time) {
  CloseInterval(impulse_ + impulse, contact_ + contact_time,
                state.arm_position(), state.position);
}

void PieceSignals::Take(const ContactPiece& piece, double duration) {
  const bool touching = Touching(piece.phase());
  const double end = piece.begin() + duration + kSlack;
  double from = 0;     // s into the piece, what is taken already
  double impulse = 0;  // up to there
  while (closed_ < intervals_ && Boundary(closed_ + 1) <= end) {
    // A frame that lies in the piece as a whole is taken as a whole.
    if (closed_ % kFilterBlock == 0 && Boundary(closed_) >= piece.begin() &&
        closed_ + kFilterBlock <= intervals_ &&
        Boundary(closed_ + kFilterBlock) <= end) {
      TakeFrames(piece, end);
      from = Boundary(closed_) - piece.begin();
      impulse = touching ? piece.Impulse(from) : 0;
      continue;
    }
    const double to = std::max(from, Boundary(closed_ + 1) - piece.begin());
    const PieceState state = piece.At(to);
    const double total = touching ? piece.Impulse(to) : 0;
    CloseInterval(impulse_ + total - impulse,
                  contact_ + (touching ? to - from : 0), state.arm_position(),
                  state.position);
    from = to;
    impulse = total;
  }
  if (touching && duration > from) {
    impulse_ += piece.Impulse(duration) - impulse;
    contact_ += duration - from;
  }
}

}  // namespace tactus::internal
