#include "core/sim/exact/bounce_ride.h"

#include <algorithm>
#include <cmath>

#include "core/sim/exact/bounce.h"
#include "core/sim/exact/bounce_series.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/butterworth.h"

namespace tactus::internal {
namespace {

// What one leap may add, as shares of the tolerance: to the speed of the
// bounces and to what drives them, as shares of these, on which the times of
// all that follow depend; and to the time, in bounces. A train may take
// thousands of leaps, and where it ends all depends on which bounce is under
// way.
constexpr double kDriveMiss = 1e-9;
constexpr double kTimeMiss = 1e-7;
// Rounding of high differences, which is no miss.
constexpr double kRideRounding = 5e-14;
// A leap spans at most this fraction of the slow motion's time scale.
constexpr double kLeapShare = 0.1;
// A stride twice as long multiplies the miss by up to this.
constexpr double kDoubled = 2 << BounceSeries::kTerms;

// A bounce, from the loss of contact to the next one.
struct Bounce {
  BounceMoment lost;
  BounceMoment made;
  BounceMoment end;
  double flight = 0;
  double contact = 0;

  BounceChange Change() const {
    BounceChange change = {};
    change[kLag] = end.lag - lost.lag;
    change[kRate] = end.rate - lost.rate;
    change[kApproach] = end.approach - lost.approach;
    change[kTime] = flight + contact;
    change[kContact] = contact;
    return change;
  }
};

BounceMoment Later(const BounceMoment& moment, const BounceChange& change) {
  BounceMoment later = moment;
  later.lag += change[kLag];
  later.rate += change[kRate];
  later.approach += change[kApproach];
  later.time += change[kTime];
  return later;
}

class Rider {
 public:
  Rider(const BounceRide& ride, PieceSink& sink, PieceSummary& summary)
      : ride_(ride),
        scene_(*ride.scene),
        modes_(*ride.modes),
        sink_(sink),
        summary_(summary),
        pieces_(sink.detail() == BounceDetail::kPieces),
        train_(scene_, modes_, *ride.leg) {}

  double Go(double time, PhaseStart& next);

 private:
  // Solves the bounce that starts at `lost`; false if it is not simple.
  bool Follow(const BounceMoment& lost, Bounce& bounce);
  // Each moves `bounce` on, the one bounce or a whole stride, and hands out
  // what is passed. False, and nothing done, if that is not possible.
  bool Step(BounceSeries& series, Bounce& bounce);
  bool Leap(BounceSeries& series, Bounce& bounce);
  // The error of a leap to `after` that misses its change by `miss`, relative
  // to the allowed error.
  double Wrong(const BounceChange& miss, double stride,
               const Bounce& after) const;
  void Lengthen(BounceSeries& series, double wrong, const Bounce& bounce);
  // True if the object certainly slides all the way.
  bool KeepsSliding(const Bounce& bounce, double stride) const;
  bool Skips(const Bounce& bounce) const;

  ContactPiece Piece(const BounceMoment& start) const {
    return {scene_,     modes_,     BounceTrain::PhaseOf(start),
            *ride_.leg, start.time, train_.StateOf(start)};
  }
  void HandPiece(const BounceMoment& start, double span);
  void HandLeap(const BounceSeries& series, const BounceMoment& origin,
                double end, bool skips);
  void HandSample(double time, const PieceState& state, double contact);
  double TakeImpulse(double time, double speed);

  const BounceRide& ride_;
  const ContactScene& scene_;
  const ContactModes& modes_;
  PieceSink& sink_;
  PieceSummary& summary_;
  const bool pieces_;
  BounceTrain train_;
  // When the sink took something last, the object's speed then, and the time
  // in contact since.
  double taken_time_ = 0;
  double taken_speed_ = 0;
  double contact_ = 0;
};

bool Rider::Follow(const BounceMoment& lost, Bounce& bounce) {
  ++summary_.solved;
  bounce.lost = lost;
  bounce.made = lost;
  bounce.flight = train_.Next(ride_.until, bounce.made);
  if (!(bounce.flight > 0)) return false;
  bounce.end = bounce.made;
  bounce.contact = train_.Next(ride_.until, bounce.end);
  return bounce.contact > 0;
}

// The contact force's impulse since the sink took something last: what the
// object's momentum gained and friction took. It slides throughout.
double Rider::TakeImpulse(double time, double speed) {
  const double impulse = scene_.object_mass_kg * (speed - taken_speed_) +
                         scene_.KineticFriction() * (time - taken_time_);
  taken_time_ = time;
  taken_speed_ = speed;
  return impulse;
}

void Rider::HandSample(double time, const PieceState& state, double contact) {
  sink_.TakeSample(state, TakeImpulse(time, state.speed), contact_ + contact);
  contact_ = -contact;
}

void Rider::HandPiece(const BounceMoment& start, double span) {
  if (pieces_) {
    sink_.Take(Piece(start), span);
    return;
  }
  const double end = start.time + span;
  double time = sink_.NextSample();
  if (time <= end) {
    const ContactPiece piece = Piece(start);
    for (; time <= end; time = sink_.NextSample()) {
      const double inside = time - start.time;
      HandSample(time, piece.At(inside), start.touching ? inside : 0);
    }
  }
  if (start.touching) contact_ += span;
}

void Rider::HandLeap(const BounceSeries& series, const BounceMoment& origin,
                     double end, bool skips) {
  const double stride = series.stride();
  for (double time; (time = sink_.NextSample()) <= end;) {
    const double share = series.ShareAt(time - origin.time);
    if (skips) {
      const BounceChange change = series.Sum(share);
      BounceMoment mean = Later(origin, change);
      mean.approach = 0;
      HandSample(time, train_.StateOf(mean), change[kContact]);
      continue;
    }
    const double whole = std::clamp(std::floor(share * stride), 0.0, stride);
    const BounceChange change = series.Sum(whole / stride);
    BounceMoment start = Later(origin, change);
    double contact = change[kContact];
    BounceMoment made = start;
    train_.Next(ride_.until, made);
    if (made.touching && made.time < time) {
      start = made;
      contact += time - made.time;
    }
    HandSample(time, Piece(start).At(std::max(0.0, time - start.time)),
               contact);
  }
  contact_ += series.Sum(1)[kContact];
}

double Rider::Wrong(const BounceChange& miss, double stride,
                    const Bounce& after) const {
  const auto excess = [](double miss, double size) {
    return std::max(0.0, std::abs(miss) / size - kRideRounding);
  };
  const double p = modes_.arm.damping();
  const double q = modes_.arm.stiffness();
  const double friction = scene_.mu_kinetic * kGravity;
  const BounceMoment& moment = after.lost;
  const double drive = std::max(
      excess(miss[kApproach], moment.approach),
      std::max(excess(q * miss[kLag], friction + q * std::abs(moment.lag)),
               excess(p * miss[kRate], friction + p * std::abs(moment.rate))));
  const double time = excess(miss[kTime], after.flight + after.contact);
  return stride / ride_.skip_tolerance *
         std::max(drive / kDriveMiss, time / kTimeMiss);
}

bool Rider::KeepsSliding(const Bounce& bounce, double stride) const {
  const double change = stride * (bounce.end.rate - bounce.lost.rate);
  return train_.StateOf(bounce.made).speed > 2 * std::abs(change);
}

bool Rider::Skips(const Bounce& bounce) const {
  if (sink_.detail() != BounceDetail::kMean) return false;
  // Fastest where the force in contact balances what brings both together
  // in flight.
  const double meeting = std::max(-bounce.lost.approach, bounce.made.approach);
  const double drive = 2 * meeting / bounce.flight;
  const double speed = std::hypot(meeting, drive / modes_.fast.fastest());
  return SkippedBounceBound(scene_, speed, bounce.flight, bounce.contact) <=
         ride_.skip_tolerance;
}

void Rider::Lengthen(BounceSeries& series, double wrong, const Bounce& bounce) {
  if (wrong * kDoubled > 1) return;
  const double span = 2 * series.stride() * (bounce.flight + bounce.contact);
  const double fastest = std::max(modes_.arm.fastest(), modes_.slow.fastest());
  if (span * fastest < kLeapShare) series.Double();
}

bool Rider::Step(BounceSeries& series, Bounce& bounce) {
  HandPiece(bounce.lost, bounce.flight);
  HandPiece(bounce.made, bounce.contact);
  ++summary_.events.contacts_made;
  ++summary_.events.contacts_lost;
  const BounceMoment end = bounce.end;
  if (!Follow(end, bounce)) return false;
  const BounceChange change = bounce.Change();
  const BounceChange miss = series.Miss(change);
  series.Add(change);
  if (!pieces_ && ride_.skip_tolerance > 0) {
    Lengthen(series, Wrong(miss, 1, bounce), bounce);
  }
  return true;
}

bool Rider::Leap(BounceSeries& series, Bounce& bounce) {
  const double stride = series.stride();
  Bounce after;
  if (!Follow(Later(bounce.lost, series.Sum(1)), after)) return false;
  const BounceChange change = after.Change();
  const double wrong = Wrong(series.Miss(change), stride, after);
  if (!(wrong < 1 && KeepsSliding(bounce, stride) &&
        KeepsSliding(after, stride))) {
    return false;
  }
  const bool skips = Skips(bounce) && Skips(after);
  HandLeap(series, bounce.lost, after.lost.time, skips);
  const auto bounces = static_cast<int64_t>(stride);
  summary_.events.contacts_made += bounces;
  summary_.events.contacts_lost += bounces;
  summary_.skipped += skips ? bounces : bounces - 1;
  bounce = after;
  series.Add(change);
  Lengthen(series, wrong, bounce);
  return true;
}

double Rider::Go(double time, PhaseStart& next) {
  BounceMoment start = train_.MomentOf(next.phase, time, next.state);
  taken_time_ = time;
  taken_speed_ = next.state.speed;
  if (start.touching) {
    const BounceMoment made = start;
    const double span = train_.Next(ride_.until, start);
    if (!(span > 0)) return time;
    HandPiece(made, span);
    ++summary_.events.contacts_lost;
  }
  Bounce bounce;
  if (Follow(start, bounce)) {
    BounceSeries series(bounce.Change());
    while (summary_.solved <= ride_.max_solved) {
      if (series.stride() > 1) {
        if (Leap(series, bounce)) continue;
        series = BounceSeries(bounce.Change());
      }
      if (!Step(series, bounce)) break;
    }
  }
  const PieceState state = train_.StateOf(bounce.lost);
  if (!pieces_) {
    sink_.TakeTotals(TakeImpulse(bounce.lost.time, state.speed), contact_);
  }
  next = {BounceTrain::PhaseOf(bounce.lost), state};
  return bounce.lost.time;
}

// Sum of the absolute changes of the anti-aliasing filter's impulse response.
double ImpulseVariation() {
  static const double variation = [] {
    Butterworth6 filter(kAntiAliasHz, kSignalRateHz);
    double sum = 0;
    double last = 0;
    for (int n = 0; n < 1000; ++n) {
      const double response = filter.Step(n == 0 ? 1 : 0);
      sum += std::abs(response - last);
      last = response;
    }
    return sum;
  }();
  return variation;
}

}  // namespace

double SkippedBounceBound(const ContactScene& scene, double speed,
                          double flight, double contact) {
  const double force = speed / (scene.mu_kinetic * kGravity);
  const double area = flight * contact / (flight + contact);
  return ImpulseVariation() * kSignalRateHz * std::max(force, area);
}

double RideBounces(const BounceRide& ride, double time, PieceSink& sink,
                   PhaseStart& next, PieceSummary& summary) {
  return Rider(ride, sink, summary).Go(time, next);
}

}  // namespace tactus::internal
