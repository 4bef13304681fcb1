#include "core/sim/exact/exact.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/errors.h"
#include "core/sim/exact/simulate_contact.h"
#include "gtest/gtest.h"
#include "tests/core/sim/random_scenes.h"
#include "tests/reference/sim/cvode.h"
#include "tests/reference/sim/long_double.h"
#include "tests/reference/sim/read_signals.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

// Largest force, area or motion error, as a fraction of the reference's peak.
double FeatureError(const IdealSignals& got, const IdealSignals& want) {
  EXPECT_EQ(got.samples.size(), want.samples.size());
  double worst = 0;
  for (int f = 0; f < kFeatureCount; ++f) {
    double peak = 0;
    double error = 0;
    for (size_t i = 0; i < want.samples.size(); ++i) {
      peak = std::max(peak, std::abs(want.samples[i][f]));
      error = std::max(error, std::abs(got.samples[i][f] - want.samples[i][f]));
    }
    if (peak > 0) worst = std::max(worst, error / peak);
  }
  return worst;
}

TrialSpec Spec(const char* material, double edge, Surface surface,
               double stiffness, double velocity, bool fixed = false) {
  TrialSpec spec;
  spec.object = {*FindMaterial(material), edge, surface};
  spec.robot = {stiffness, velocity, kPaperGoal};
  spec.fixed = fixed;
  return spec;
}

// Features of the paper's trials against the slow reference: never touched
// off, slip once, stick and slip, bounce tens to thousands of times. All of
// the set is compared by `tactus-bench sim`.
TEST(IntegrateExactTest, FeaturesAreThoseOfTheReference) {
  const TrialSpec specs[] = {
      Spec("fat", 0.01, Surface::kGlass, 543, 0.005),
      Spec("muscle", 0.0733, Surface::kGlass, 2050, 0.005),
      Spec("soft-foam", 0.01, Surface::kWood, 2050, 0.02),
      Spec("light-foam", 0.0944, Surface::kGlass, 2050, 0.02),
      Spec("natural-rubber", 0.0311, Surface::kWood, 543, 0.02),
      Spec("abs-plastic", 0.0733, Surface::kGlass, 543, 0.02),
      Spec("abs-plastic", 0.2, Surface::kWood, 543, 0.02, true),
  };
  SimulateOptions options;
  options.exact.skip_tolerance = 0;
  for (const TrialSpec& spec : specs) {
    const auto contact = SimulateContact(spec, options);
    ASSERT_TRUE(contact.ok()) << contact.status();
    const auto reference = IntegrateReference(SceneOf(spec), 2000);
    ASSERT_TRUE(reference.ok()) << reference.status();
    EXPECT_EQ(contact->moved, reference->moved);
    EXPECT_EQ(contact->events.Total(), reference->events.Total());
    EXPECT_LT(
        FeatureError(contact->signals, ReadSignals(spec.object, *reference)),
        1e-6)
        << contact->Metadata().object;
  }
}

// The same for arms, objects and frictions far from the paper's; every second
// arm moves when it touches.
TEST(IntegrateExactTest, RandomScenesFollowTheReference) {
  Random random(11);
  int compared = 0;
  int moved = 0;
  while (compared < 50) {
    ContactScene scene = RandomScene(random);
    scene.duration_s = 0.3;
    if (compared % 2 == 1) {
      scene.touch_speed_m_s = scene.velocity_m_s * (0.1 + 0.02 * compared);
      scene.lead_m = scene.goal_m * 0.018 * compared;
    }
    if (RingingRate(scene) > 2e4) continue;
    if (compared % 4 >= 2) SetRetreat(random, scene);
    ++compared;
    const auto run = IntegrateExact(scene, {});
    ASSERT_TRUE(run.ok()) << run.status();
    const auto reference = IntegrateReference(scene, 2000);
    ASSERT_TRUE(reference.ok());
    ASSERT_EQ(run->samples.size(), reference->samples.size());
    moved += run->moved;
    EXPECT_EQ(run->moved, reference->moved);
    EXPECT_EQ(run->events.Total(), reference->events.Total()) << compared;
    const TrajectorySample& end = run->samples.back();
    const TrajectorySample& want = reference->samples.back();
    EXPECT_NEAR(end.x_arm, want.x_arm, 1e-8 * scene.goal_m) << compared;
    EXPECT_NEAR(end.x_uobj, want.x_uobj, 1e-8 * scene.goal_m) << compared;
    EXPECT_NEAR(end.impulse, want.impulse, 1e-8 * want.impulse) << compared;
  }
  EXPECT_GT(moved, 25);
}

// CVODE resolves the ringing of a retreat at tight tolerances, and the arm lets
// go for good.
TEST(IntegrateExactTest, ARetreatIsThatOfCvode) {
  Random random(12);
  int compared = 0;
  while (compared < 20) {
    ContactScene scene = RandomScene(random);
    scene.actuator_damping =
        CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
    scene.duration_s = 2;
    scene.retreat_after_s = random.Uniform(0.1, 0.5);
    scene.retreat_speed_m_s = 0.1;
    if (RingingRate(scene) > 3e3) continue;
    ++compared;
    SolverOptions tight;
    tight.relative_tolerance = 1e-9;
    tight.force_tolerance = 1e-9;
    tight.velocity_tolerance = 1e-11;
    tight.position_tolerance = 1e-12;
    tight.ringing_order = 5;
    const auto run = IntegrateExact(scene, {});
    const auto cvode = IntegrateCvode(scene, tight);
    ASSERT_TRUE(run.ok() && cvode.ok()) << run.status() << cvode.status();
    ASSERT_EQ(run->samples.size(), cvode->samples.size());
    EXPECT_EQ(run->moved, cvode->moved) << compared;
    const TrajectorySample& end = run->samples.back();
    const TrajectorySample& want = cvode->samples.back();
    EXPECT_NEAR(end.x_uobj, want.x_uobj, 1e-5 * scene.goal_m) << compared;
    EXPECT_NEAR(end.contact_time, want.contact_time, 1e-4) << compared;
    for (size_t i = 0; i < run->samples.size(); ++i) {
      ASSERT_NEAR(run->samples[i].x_arm, cvode->samples[i].x_arm,
                  1e-5 * scene.goal_m)
          << compared << " sample " << i;
    }
    EXPECT_NEAR(end.impulse, want.impulse, 1e-4 * want.impulse) << compared;
    EXPECT_EQ(end.force, 0);
    EXPECT_NEAR(end.v_arm, -scene.retreat_speed_m_s, 5e-3);
    EXPECT_LT(end.x_arm, end.x_uobj);
  }
}

// Checks every piece of a contact when it is solved.
class PieceChecker : public PieceSink {
 public:
  explicit PieceChecker(const ContactScene& scene) : s_(scene) {}

  BounceDetail detail() const override { return BounceDetail::kPieces; }
  double NextSample() const override { return 0; }
  void TakeSample(const PieceState&, double, double) override { FAIL(); }
  void TakeTotals(double, double) override { FAIL(); }

  void Take(const ContactPiece& piece, double duration) override {
    ++pieces_;
    ASSERT_GE(duration, 0);
    EXPECT_NEAR(piece.begin(), time_, 1e-12);
    CheckContinuity(piece.start());
    end_ = piece.At(duration);
    time_ = piece.begin() + duration;
    CheckSides(piece, duration);
    CheckBalance(piece, duration);
  }

  int pieces() const { return pieces_; }
  int balanced() const { return balanced_; }
  double time() const { return time_; }

 private:
  void CheckContinuity(const PieceState& start) const {
    const double x = 1e-9 * s_.goal_m;
    EXPECT_NEAR(start.arm_position(), end_.arm_position(), x);
    EXPECT_NEAR(start.position, end_.position, x);
    EXPECT_NEAR(start.arm_speed(), end_.arm_speed(), 1e-9 * s_.velocity_m_s);
    EXPECT_NEAR(start.speed, end_.speed, 1e-9 * s_.velocity_m_s);
  }

  // The force only pushes. Arm and object do not overlap while they are not in
  // contact. The object never moves back and never rests above the static
  // limit.
  void CheckSides(const ContactPiece& piece, double duration) const {
    const bool touching = Touching(piece.phase());
    double size = 0;
    for (int i = 0; i <= 64; ++i) {
      const PieceState state = piece.At(duration * i / 64);
      size = std::max(size, std::abs(state.deformation));
    }
    for (int i = 0; i <= 64; ++i) {
      const PieceState state = piece.At(duration * i / 64);
      ASSERT_TRUE(std::isfinite(state.deformation + state.arm_speed()));
      const double noise = 1e-9 * size + 1e-17;
      EXPECT_GE(touching ? state.deformation : -state.deformation, -noise);
      EXPECT_GE(state.speed, -1e-9 * s_.velocity_m_s);
      if (piece.phase() == ContactPhase::kStuck && !s_.fixed) {
        EXPECT_LE(piece.stiffness() * state.deformation,
                  s_.StaticLimit() * (1 + 1e-9));
      }
      if (!Sliding(piece.phase())) {
        EXPECT_EQ(state.speed, 0);
      }
    }
  }

  // Momentum of arm and object, and energy, by Gauss-Legendre quadrature of
  // the actuator's force and power.
  void CheckBalance(const ContactPiece& piece, double duration) {
    const double rate = Touching(piece.phase())
                            ? RingingRate(s_)
                            : std::sqrt(s_.actuator_stiffness / s_.arm_mass_kg);
    const double fastest = std::max(rate, s_.actuator_damping / s_.arm_mass_kg);
    const int parts = static_cast<int>(std::ceil(duration * fastest)) + 1;
    if (parts > 2000) return;
    ++balanced_;
    constexpr double kNodes[] = {0.04691007703066802, 0.23076534494715845, 0.5,
                                 0.76923465505284155, 0.95308992296933198};
    constexpr double kWeights[] = {0.11846344252809454, 0.23931433524968324,
                                   0.28444444444444444, 0.23931433524968324,
                                   0.11846344252809454};
    const double begin = piece.begin() * (1 + 1e-12);
    const double turn = s_.retreat_after_s;
    const double speed = begin >= turn          ? -s_.retreat_speed_m_s
                         : begin < s_.RampEnd() ? s_.velocity_m_s
                                                : 0;
    double push = 0;
    double work = 0;
    double gross = 0;
    for (int part = 0; part < parts; ++part) {
      for (int node = 0; node < 5; ++node) {
        const double t = (part + kNodes[node]) / parts * duration;
        const PieceState state = piece.At(t);
        const double time = piece.begin() + t;
        const double equilibrium =
            std::min(s_.velocity_m_s * std::min(time, turn), s_.goal_m) -
            (time > turn ? s_.retreat_speed_m_s * (time - turn) : 0);
        const double force =
            s_.actuator_stiffness * (equilibrium - state.arm_position()) +
            s_.actuator_damping * (speed - state.arm_speed());
        const double weight = kWeights[node] / parts * duration;
        push += weight * force;
        work += weight * force * state.arm_speed();
        gross += weight * std::abs(force * state.arm_speed());
      }
    }
    const PieceState& a = piece.start();
    const PieceState& b = end_;
    const double m = s_.arm_mass_kg;
    const double mass = s_.object_mass_kg;
    const double impulse = piece.Impulse(duration);
    const double scale = m * s_.velocity_m_s;
    EXPECT_NEAR(m * (b.arm_speed() - a.arm_speed()), push - impulse,
                1e-9 * (scale + std::abs(impulse)));
    if (Sliding(piece.phase())) {
      EXPECT_NEAR(mass * (b.speed - a.speed),
                  impulse - s_.KineticFriction() * duration,
                  1e-9 * (scale + std::abs(impulse)));
    }
    const auto energy = [&](const PieceState& state) {
      return 0.5 * m * state.arm_speed() * state.arm_speed() +
             0.5 * mass * state.speed * state.speed +
             0.5 * piece.stiffness() * state.deformation * state.deformation;
    };
    EXPECT_NEAR(energy(b) - energy(a),
                work - s_.KineticFriction() * (b.position - a.position),
                1e-8 * (gross + energy(a) + energy(b)));
  }

  const ContactScene& s_;
  PieceState end_;
  double time_ = 0;
  int pieces_ = 0;
  int balanced_ = 0;
};

TEST(SolvePiecesTest, EveryPieceObeysTheModel) {
  Random random(3);
  int pieces = 0;
  int balanced = 0;
  for (int i = 0; i < 100; ++i) {
    ContactScene scene = RandomScene(random);
    // Thousands of bounces would repeat the same check.
    scene.duration_s = RingingRate(scene) > 3e4 ? 0.01 : 1;
    // Every second arm lifts off.
    if (i % 2 == 1) SetRetreat(random, scene);
    PieceChecker checker(scene);
    const auto summary = SolvePieces(scene, {}, checker);
    ASSERT_TRUE(summary.ok()) << summary.status();
    EXPECT_NEAR(checker.time(), scene.duration_s, 1e-12);
    pieces += checker.pieces();
    balanced += checker.balanced();
    ASSERT_FALSE(HasFailure()) << "scene " << i;
  }
  EXPECT_GT(pieces, 1000);
  EXPECT_GT(balanced, pieces / 2);
}

// The motion between events is the same however it is sampled.
TEST(IntegrateExactTest, DoesNotDependOnTheSamplingRate) {
  Random random(4);
  for (int i = 0; i < 60; ++i) {
    ContactScene scene = RandomScene(random);
    scene.duration_s = RingingRate(scene) > 1e6 ? 0.02 : 0.5;
    ExactOptions coarse;
    coarse.sample_rate_hz = 500;
    ExactOptions fine;
    fine.sample_rate_hz = 10000;
    const auto few = IntegrateExact(scene, coarse);
    const auto many = IntegrateExact(scene, fine);
    ASSERT_TRUE(few.ok() && many.ok());
    EXPECT_EQ(few->events.Total(), many->events.Total());
    for (size_t n = 0; n < few->samples.size(); ++n) {
      const TrajectorySample& a = few->samples[n];
      const TrajectorySample& b = many->samples[20 * n];
      ASSERT_EQ(a.x_arm, b.x_arm) << n;
      ASSERT_EQ(a.x_uobj, b.x_uobj) << n;
      ASSERT_EQ(a.force, b.force) << n;
      ASSERT_NEAR(a.impulse, b.impulse, 1e-11 * b.impulse) << n;
    }
  }
}

// Slow and fast pair coincide when equal masses are on equal springs with a
// critically damped arm.
TEST(IntegrateExactTest, CoincidingModesAreNoSpecialCase) {
  for (double mass : {1.167, 1.167 * (1 + 1e-13), 1.168}) {
    ContactScene scene;
    scene.actuator_damping =
        CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
    scene.velocity_m_s = 0.1;
    scene.object_mass_kg = mass;
    scene.object_stiffness = scene.actuator_stiffness;
    scene.mu_static = 0.12;
    scene.mu_kinetic = 0.1;
    const auto run = IntegrateExact(scene, {});
    const auto reference = IntegrateReference(scene, 2000);
    ASSERT_TRUE(run.ok() && reference.ok());
    EXPECT_TRUE(run->moved);
    for (size_t n = 0; n < run->samples.size(); ++n) {
      ASSERT_NEAR(run->samples[n].x_uobj, reference->samples[n].x_uobj, 1e-11);
      ASSERT_NEAR(run->samples[n].force, reference->samples[n].force, 1e-7);
    }
  }
}

TEST(IntegrateExactTest, AFixedObjectStaysPutExactly) {
  ContactScene scene =
      SceneOf(Spec("steel", 0.01, Surface::kWood, 543, 0.02, true));
  const auto run = IntegrateExact(scene, {});
  ASSERT_TRUE(run.ok());
  EXPECT_FALSE(run->moved);
  for (const TrajectorySample& sample : run->samples) {
    ASSERT_EQ(sample.x_uobj, 0);
    ASSERT_EQ(sample.v_uobj, 0);
  }
  const double k = scene.object_stiffness;
  EXPECT_NEAR(run->samples.back().force, 543 * k / (543 + k) * scene.goal_m,
              1e-12);
}

// In each scene every bounce is solved: thousands of bounces, a bounce that the
// end of the ramp forces to rest, and a very light object that meets the arm a
// million times per second. The last motion is replaced by its mean where the
// error bound allows it.
TEST(SkippedBouncesTest, ChangeTheSignalsByLessThanTolerated) {
  const TrialSpec specs[] = {
      Spec("pine-wood", 0.0733, Surface::kGlass, 543, 0.02),
      Spec("abs-plastic", 0.01, Surface::kGlass, 2050, 0.02),
      Spec("steel", 0.001, Surface::kGlass, 543, 0.02),
  };
  for (const TrialSpec& spec : specs) {
    SimulateOptions solve;
    solve.exact.skip_tolerance = 0;
    const auto solved = SimulateContact(spec, solve);
    ASSERT_TRUE(solved.ok()) << solved.status();
    EXPECT_EQ(solved->skipped_bounces, 0);
    int64_t last = 0;
    for (double tolerance : {1e-4, 1e-3, 1e-2, 1e-1}) {
      SimulateOptions skip;
      skip.exact.skip_tolerance = tolerance;
      const auto skipped = SimulateContact(spec, skip);
      ASSERT_TRUE(skipped.ok()) << skipped.status();
      EXPECT_LT(FeatureError(skipped->signals, solved->signals), tolerance);
      EXPECT_EQ(skipped->moved, solved->moved);
      EXPECT_NEAR(skipped->events.Total(), solved->events.Total(),
                  tolerance * solved->events.Total());
      EXPECT_GE(skipped->skipped_bounces, last);
      last = skipped->skipped_bounces;
    }
    EXPECT_GT(last, solved->events.Total() / 4);
  }
}

// 631,473 events: the rounding errors of the bounces must not add up. Leaps
// solve a sixth of the bounces, so a bias would show in the difference.
TEST(SkippedBouncesTest, RoundingDoesNotAddUpOverALongTrain) {
  const TrialSpec spec = Spec("glass", 0.01, Surface::kGlass, 543, 0.005);
  SimulateOptions options;
  options.exact.skip_tolerance = 0;
  const auto solved = SimulateContact(spec, options);
  options.exact.skip_tolerance = 1e-6;
  const auto skipped = SimulateContact(spec, options);
  ASSERT_TRUE(solved.ok() && skipped.ok());
  EXPECT_GT(solved->events.Total(), 600'000);
  EXPECT_EQ(solved->events.Total(), skipped->events.Total());
  EXPECT_LT(FeatureError(solved->signals, skipped->signals), 1.5e-6);
}

TEST(IntegrateExactTest, TooManyEventsAreAnErrorNotAStall) {
  ExactOptions options;
  options.max_events = 100;
  const auto run = IntegrateExact(
      SceneOf(Spec("pine-wood", 0.01, Surface::kGlass, 543, 0.005)), options);
  EXPECT_EQ(ReasonOf(run.status()), "NUMERICAL_FAILURE");
}

TEST(IntegrateExactTest, ABadRateIsNamed) {
  const ContactScene scene =
      SceneOf(Spec("fat", 0.1, Surface::kWood, 543, 0.02));
  for (double rate : {0.0, -1.0, 1050.0, std::nan(""), 1e9}) {
    ExactOptions options;
    options.sample_rate_hz = rate;
    const auto run = IntegrateExact(scene, options);
    EXPECT_EQ(ReasonOf(run.status()), "INVALID_SCENE");
    EXPECT_EQ(InfoOf(run.status()).metadata().at("field"),
              "exact.sample_rate_hz");
  }
}

}  // namespace
}  // namespace tactus::internal
