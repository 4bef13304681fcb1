#include "core/sim/piece_signals.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kInterval = 1 / kSignalRateHz;
// Boundaries may lie a rounding beyond the piece that ends there, s.
constexpr double kSlack = 1e-12;
// Longer than any contact, s.
constexpr double kForever = 1e3;
// Of the signal: what pairs that have faded may still add to it.
constexpr double kFaded = 1e-14;
// Frames after which no more is left of what was in the filter: its slowest
// mode fades by 25 in one.
constexpr int kFilterFrames = 10;
// Of the area: what the square of the pairs' share of the strain may add.
constexpr double kLinear = 1e-12;
// Share by which the thickness may change in half a frame, for its powers
// beyond kRampPowers to be lost beside 1.
constexpr double kSlowRamp = 0.01;

double Dot(const std::array<double, 2>& row, const PairState& state) {
  return row[0] * state.value + row[1] * state.rate;
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
      pair.force_drive[from] = filter_.Drive(forces);
      pair.motion_drive[from] = filter_.Drive(motions);
    }
  }
}

BlockFilter::Column PieceSignals::AreaDrive(
    const PieceForm& force, const FrameStart& start, const PhaseTable& table,
    const BlockFilter::Column& pair_drive) {
  constexpr double kFrame = kFilterBlock * kInterval;
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
    BlockFilter::Column drive = {};
    const double scale = full_area_ * std::pow(middle, -exponent);
    double term = scale;
    for (int n = 0; n < kRampPowers && std::abs(term) > 1e-17 * scale; ++n) {
      Add(term, filter_.ramp_power(n), drive);
      term *= ramp * (exponent + n) / (n + 1);
    }
    Add(scale * exponent * strain_per_newton_ / middle, pair_drive, drive);
    return drive;
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
  return filter_.Drive(Areas(forces));
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
  // Frames since the input of the filter stopped changing.
  int settled = 0;
  bool last_clamped = false;
  while (closed_ + kFilterBlock <= intervals_ &&
         Boundary(closed_ + kFilterBlock) <= end) {
    if (settled > kFilterFrames) {
      signals_.samples.push_back(signals_.samples.back());
      signals_.object_motion.push_back(signals_.object_motion.back());
      signals_.clamped += last_clamped;
      closed_ += kFilterBlock;
      continue;
    }
    time = Boundary(closed_) - piece.begin();
    start.force = force.constant + force.slope * (time + kInterval / 2);
    BlockFilter::Column force_drive = {};
    BlockFilter::Column motion_drive = {};
    Add(motion.constant + motion.slope * (time + kInterval), filter_.constant(),
        motion_drive);
    Add(motion.slope * kInterval, filter_.ramp(), motion_drive);
    for (int i = 0; i < start.used; ++i) {
      const PairTable& pair = table.pairs[i];
      const PairState& state = start.states[i];
      if (touching) {
        Add(state.value, pair.force_drive[0], force_drive);
        Add(state.rate, pair.force_drive[1], force_drive);
      }
      Add(state.value, pair.motion_drive[0], motion_drive);
      Add(state.rate, pair.motion_drive[1], motion_drive);
    }
    BlockFilter::Column area_drive = {};
    if (with_area_ && touching) {
      area_drive = AreaDrive(force, start, table, force_drive);
    }
    Add(start.force, filter_.constant(), force_drive);
    Add(force.slope * kInterval, filter_.ramp(), force_drive);
    last_clamped = clamped_;

    for (int i = 0; i < start.used; ++i) {
      const auto& frame = table.pairs[i].frame;
      start.states[i] = {Dot(frame[0], start.states[i]),
                         Dot(frame[1], start.states[i])};
    }
    closed_ += kFilterBlock;
    const bool constant = Settled(force, start) && Settled(motion, start) &&
                          !Sliding(piece.phase());
    settled = constant ? settled + 1 : 0;
    time = Boundary(closed_) - piece.begin();
    const double position = piece.phase() == ContactPhase::kCoasting
                                ? piece.At(time).position
                                : object.constant + object.slope * time +
                                      object.value[0] * start.states[0].value +
                                      object.value[1] * start.states[1].value;
    CloseFrame(force_drive, area_drive, motion_drive, position);
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
    CloseFrame(filter_.Drive(force_), filter_.Drive(area_),
               filter_.Drive(motion_), object);
  }
}

void PieceSignals::CloseFrame(const BlockFilter::Column& force_drive,
                              const BlockFilter::Column& area_drive,
                              const BlockFilter::Column& motion_drive,
                              double object) {
  force_state_ = filter_.Advance(force_state_, force_drive);
  if (with_area_) area_state_ = filter_.Advance(area_state_, area_drive);
  motion_state_ = filter_.Advance(motion_state_, motion_drive);
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

}  // namespace tactus
