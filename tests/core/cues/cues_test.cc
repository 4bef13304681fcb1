#include <cmath>
#include <set>

#include "core/base/random.h"
#include "core/cues/cue_group.h"
#include "core/cues/cue_tracker.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using Samples = std::vector<ContactSample>;

ContactSample Sample(double force, double area, double motion) {
  return {{force, area, motion}, force};
}

// A spring of `stiffness` pressed at 10 mm/s, sliding from frame `slip` on.
Samples Press(double stiffness, int frames, int slip) {
  Samples samples;
  for (int t = 1; t <= frames; ++t) {
    const double motion = 0.0001 * t;
    const double pressed = 0.0001 * std::min(t, slip);
    samples.push_back(Sample(stiffness * pressed, 1e-3, motion));
  }
  return samples;
}

CueTracker After(const Samples& samples) {
  CueTracker tracker(100);
  for (size_t i = 0; i < samples.size(); ++i) tracker.Step(samples[i], i + 1);
  return tracker;
}

// Weights of a mean that becomes a running one over `window` samples, from
// the recursion's closed form.
std::vector<long double> Weights(size_t count, size_t window) {
  std::vector<long double> weights(count, 1.0L);
  for (size_t i = 0; i < count; ++i) {
    weights[i] = 1.0L / std::min(i + 1, window);
    for (size_t j = 0; j < i; ++j) weights[j] *= 1 - weights[i];
  }
  return weights;
}

TEST(CueTest, NamesRoundTripAndAreUnique) {
  for (int i = 0; i < CueCount(); ++i) {
    const Cue cue = static_cast<Cue>(i);
    EXPECT_EQ(ParseCue(CueName(cue)), cue);
  }
  EXPECT_FALSE(ParseCue("log_nothing"));
  EXPECT_EQ(CueName(RawCue(Feature::kMotion)), "motion");
  EXPECT_FALSE(NeedsFeature(NamedCue("log_spring"), Feature::kArea));
  EXPECT_TRUE(NeedsFeature(NamedCue("log_spring"), Feature::kMotion));
}

TEST(CueTest, ASpringThatRestsShowsItsStiffness) {
  CueTracker tracker = After(Press(2000, 100, 1000));
  for (Cue cue : {NamedCue("log_spring"), NamedCue("log_slope"),
                  NamedCue("log_stiffest_spring"), NamedCue("log_stiffness")}) {
    EXPECT_NEAR(tracker.value(cue), std::log(2000), 1e-9) << CueName(cue);
  }
  for (Cue cue : {NamedCue("stiffness_short"), NamedCue("stiffness_long")}) {
    EXPECT_NEAR(tracker.value(cue), std::log1p(2000 / 1e3), 1e-9);
  }
  EXPECT_NEAR(tracker.value(NamedCue("log_spring_misfit")), std::log(1e-4),
              1e-6);
  EXPECT_NEAR(tracker.value(NamedCue("log_speed")), std::log(0.01), 0.05);
}

TEST(CueTest, SlidingShowsAsMisfitAndKeepsTheStiffestSpring) {
  CueTracker tracker = After(Press(2000, 200, 20));
  EXPECT_NEAR(tracker.value(NamedCue("log_stiffest_spring")), std::log(2000),
              1e-9);
  EXPECT_LT(tracker.value(NamedCue("log_spring")), std::log(500));
  EXPECT_GT(tracker.value(NamedCue("log_spring_misfit")), std::log(0.1));
  EXPECT_NEAR(tracker.value(NamedCue("stiffness_short")), 0, 1e-6);
}

TEST(CueTest, StiffnessHoldsAtAnySpeedAndArm) {
  const Samples slow = Press(2000, 400, 1000);
  Samples fast;
  for (size_t i = 3; i < slow.size(); i += 4) fast.push_back(slow[i]);
  for (Cue cue : {NamedCue("log_spring"), NamedCue("log_slope"),
                  NamedCue("log_stiffness")}) {
    EXPECT_NEAR(After(slow).value(cue), After(fast).value(cue), 1e-9);
  }
}

// Two cubes of one density and friction: drag goes with the edge's cube, area
// with its square.
TEST(CueTest, DragOfWhatSlidesDoesNotDependOnItsSize) {
  const auto slide = [](double edge) {
    const double friction = 0.3 * 2700 * 9.81 * edge * edge * edge;
    return After(Samples(50, Sample(friction, edge * edge, 0.01)));
  };
  EXPECT_NEAR(slide(0.01).value(NamedCue("log_drag")),
              std::log(0.3 * 2700 * 9.81), 1e-9);
  EXPECT_NEAR(slide(0.05).value(NamedCue("log_drag")),
              std::log(0.3 * 2700 * 9.81), 1e-9);
}

// Every windowed cue from all samples at once, in long double.
TEST(CueTest, WindowsAgreeWithWeightedSumsOverAllSamples) {
  Random random(3);
  Samples samples;
  CueTracker tracker(100);
  for (int t = 1; t <= 120; ++t) {
    samples.push_back(Sample(random.Uniform(1, 2), random.Uniform(0.001, 0.002),
                             random.Uniform(0.01, 0.02)));
    tracker.Step(samples.back(), t);
    struct Case {
      size_t window;
      Cue stiffness;
      Cue force_ripple;
      Cue area_response;
    };
    for (const Case& c :
         {Case{10, NamedCue("stiffness_short"), NamedCue("force_ripple_short"),
               NamedCue("area_response_short")},
          Case{40, NamedCue("stiffness_long"), NamedCue("force_ripple_long"),
               NamedCue("area_response_long")}}) {
      const auto w = Weights(samples.size(), c.window);
      long double f = 0, a = 0, m = 0, ff = 0, mm = 0, fm = 0, fa = 0;
      for (size_t i = 0; i < samples.size(); ++i) {
        f += w[i] * samples[i].features[0];
        a += w[i] * samples[i].features[1];
        m += w[i] * samples[i].features[2];
      }
      for (size_t i = 0; i < samples.size(); ++i) {
        const long double df = samples[i].features[0] - f;
        const long double da = samples[i].features[1] - a;
        const long double dm = samples[i].features[2] - m;
        ff += w[i] * df * df;
        mm += w[i] * dm * dm;
        fm += w[i] * df * dm;
        fa += w[i] * df * da;
      }
      if (t < 3) continue;
      const long double k = fm / mm;
      EXPECT_NEAR(
          tracker.value(c.stiffness),
          static_cast<double>(std::copysign(std::log1p(std::abs(k) / 1e3L), k)),
          1e-9);
      EXPECT_NEAR(tracker.value(c.force_ripple),
                  static_cast<double>(std::log(std::sqrt(ff) / f)), 1e-9);
      const long double response = fa / ff * f / a;
      EXPECT_NEAR(tracker.value(c.area_response),
                  static_cast<double>(std::copysign(
                      std::log1p(std::abs(response) / 1e-5L), response)),
                  1e-8);
    }
  }
}

// From the definitions, with the weights of a running mean.
TEST(CueTest, TremorIsTheChangeOfTheForceAndPitchTheChangeOfThat) {
  Random random(11);
  CueTracker tracker(100);
  std::vector<long double> force, change, turn;
  for (int t = 1; t <= 120; ++t) {
    force.push_back(random.Uniform(0.5, 0.6));
    change.push_back(t == 1 ? 0 : force[t - 1] - force[t - 2]);
    turn.push_back(t <= 2 ? 0 : change[t - 1] - change[t - 2]);
    tracker.Step(Sample(static_cast<double>(force.back()), 1e-3, 0), t);
    if (t < 3) continue;
    const auto expect = [&](Cue tremor, Cue pitch, size_t window) {
      const std::vector<long double> weights = Weights(t, window);
      long double level = 0, changes = 0, turns = 0;
      for (int i = 0; i < t; ++i) {
        level += weights[i] * force[i];
        changes += weights[i] * change[i] * change[i];
        turns += weights[i] * turn[i] * turn[i];
      }
      EXPECT_NEAR(tracker.value(tremor),
                  static_cast<double>(std::log(std::sqrt(changes) / level)),
                  1e-6);
      EXPECT_NEAR(tracker.value(pitch),
                  static_cast<double>(std::log(turns / changes) / 2), 1e-6);
    };
    expect(NamedCue("force_tremor_short"), NamedCue("force_pitch_short"), 10);
    expect(NamedCue("force_tremor_long"), NamedCue("force_pitch_long"), 40);
  }
}

// The change of a sine of frequency w is a sine of the same frequency, whose
// own change is 2 sin(w / 2) as large.
TEST(CueTest, PitchIsTheFrequencyOfATremor) {
  for (const double hertz : {3.0, 10.0, 25.0, 45.0}) {
    for (const double amplitude : {1e-4, 0.2}) {
      CueTracker tracker(100);
      for (int t = 1; t <= 2000; ++t) {
        const double angle = 2 * M_PI * hertz * t / 100;
        tracker.Step(Sample(1 + amplitude * std::sin(angle), 1e-3, 0), t);
      }
      EXPECT_NEAR(tracker.value(NamedCue("force_pitch_long")),
                  std::log(2 * std::sin(M_PI * hertz / 100)), 0.05)
          << hertz;
    }
  }
}

TEST(CueTest, AForceAtRestHasNoPitch) {
  CueTracker tracker(100);
  for (int t = 1; t <= 500; ++t) {
    tracker.Step(Sample(0.7 * (1 + 1e-13 * (t % 2)), 1e-3, 0), t);
  }
  EXPECT_NEAR(tracker.value(NamedCue("force_pitch_long")), 0, 1e-6);
  EXPECT_NEAR(tracker.value(NamedCue("force_tremor_long")), std::log(1e-6),
              1e-6);
}

TEST(CueTest, SpreadIsSmoothAndInMetres) {
  CueTracker tracker(100);
  ContactSample sample = Sample(1, 1e-3, 0);
  for (int t = 1; t <= 100; ++t) {
    sample.spread = {1e-4F, 0};
    tracker.Step(sample, t);
  }
  EXPECT_NEAR(tracker.value(NamedCue("log_row_spread")), std::log(1e-2), 1e-6);
  EXPECT_NEAR(tracker.value(NamedCue("log_column_spread")), std::log(1e-5),
              1e-6);
  // 50 ms are 5 samples.
  sample.spread.rows = 6e-4F;
  tracker.Step(sample, 101);
  EXPECT_NEAR(tracker.value(NamedCue("log_row_spread")), std::log(2e-4) / 2,
              1e-6);
}

TEST(CueTest, TheLoadProfileIsPassedOnAsItIs) {
  const std::vector<Cue> cues = CuesOfGroup("load_profile");
  ASSERT_EQ(cues.size(), static_cast<size_t>(kProfileSize));
  EXPECT_EQ(CueName(cues.front()), "row_load_0");
  EXPECT_EQ(CueName(cues[kRowBands]), "column_load_0");
  EXPECT_EQ(CueName(cues.back()), "column_load_9");
  CueTracker tracker(100);
  for (int t = 1; t <= 3; ++t) {
    ContactSample sample = Sample(1, 1, 1);
    for (int i = 0; i < kProfileSize; ++i) sample.profile[i] = 100 * t + i;
    tracker.Step(sample, t);
    for (int i = 0; i < kProfileSize; ++i) {
      EXPECT_EQ(tracker.value(cues[i]), sample.profile[i]);
      EXPECT_EQ(SourcesOf(cues[i]), kFromProfile);
      EXPECT_TRUE(NeedsFeature(cues[i], Feature::kForce));
      EXPECT_FALSE(NeedsFeature(cues[i], Feature::kArea));
      EXPECT_FALSE(NeedsFeature(cues[i], Feature::kMotion));
    }
  }
}

TEST(CueTest, EveryCueIsInOneGroup) {
  size_t cues = 0;
  std::set<absl::string_view> names;
  for (const CueGroup& group : AllCueGroups()) {
    const std::vector<Cue> of_group = CuesOfGroup(group.name);
    EXPECT_TRUE(names.insert(group.name).second) << group.name;
    cues += of_group.size();
    for (size_t i = 0; i < of_group.size(); ++i) {
      EXPECT_EQ(GroupOf(of_group[i]), GroupOf(of_group.front()));
      EXPECT_EQ(PlaceInGroup(of_group[i]), i);
      EXPECT_EQ(SourcesOf(of_group[i]), group.sources);
    }
  }
  EXPECT_EQ(cues, static_cast<size_t>(CueCount()));
  EXPECT_TRUE(CuesOfGroup("nothing").empty());
  EXPECT_EQ(StandardCues().size(), 30u);
  for (const Cue cue : StandardCues()) EXPECT_EQ(SourcesOf(cue), 0u);
}

TEST(CueTest, AGroupNeedsNoOther) {
  for (const CueGroup& group : AllCueGroups()) {
    const CueGroups only = GroupOf(CuesOfGroup(group.name).front());
    Random random(3);
    CueTracker all(100);
    CueTracker some(100, only);
    for (int t = 1; t <= 200; ++t) {
      ContactSample sample = {{random.Uniform(0, 5), random.Uniform(0, 1e-2),
                               random.Uniform(0, 0.02)},
                              random.Uniform(0, 9)};
      sample.profile[3] = random.Uniform();
      sample.spread = {static_cast<float>(random.Uniform()), 1e-4F};
      all.Step(sample, t);
      some.Step(sample, t);
      for (int i = 0; i < CueCount(); ++i) {
        const Cue cue = static_cast<Cue>(i);
        const bool has = i < kFeatureCount || GroupOf(cue) == only;
        EXPECT_EQ(some.value(cue), has ? all.value(cue) : 0) << CueName(cue);
      }
    }
  }
}

TEST(CueTest, CuesAreTheSameHoweverSeldomTheyAreRead) {
  Random random(4);
  CueTracker often(100);
  CueTracker seldom(100);
  for (int t = 1; t <= 300; ++t) {
    const ContactSample sample =
        Sample(random.Uniform(0, 2), random.Uniform(0, 0.002),
               random.Uniform(0, 0.02));
    often.Step(sample, t);
    seldom.Step(sample, t);
    EXPECT_EQ(often.value(Cue::kForce), sample.features[0]);
    for (Cue cue : StandardCues()) {
      const double value = often.value(cue);
      if (t % 37 == 0) {
        EXPECT_EQ(seldom.value(cue), value) << CueName(cue);
      }
    }
  }
}

// From its definition: the largest ratio of mean products so far.
TEST(CueTest, TheStiffestSpringIsTheLargestSpringSoFar) {
  Random random(5);
  CueTracker tracker(100);
  double stiffest = -HUGE_VAL;
  for (int t = 1; t <= 300; ++t) {
    tracker.Step(Sample(random.Uniform(0, 2), 1e-3, random.Uniform(0, 0.02)),
                 t);
    stiffest = std::max(stiffest, tracker.value(NamedCue("log_spring")));
    EXPECT_NEAR(tracker.value(NamedCue("log_stiffest_spring")), stiffest,
                1e-13);
  }
}

TEST(CueTest, AnyFiniteSampleGivesFiniteCues) {
  const double values[] = {0,     -1,     1e-308, 5e-324, 1e-30, 1e30,
                           1e300, -1e300, 1,      1e-7,   12};
  Random random(9);
  CueTracker tracker(100);
  auto pick = [&] { return values[random.Index(std::size(values))]; };
  for (uint64_t t = 1; t <= 5000; ++t) {
    if (t % 100 == 0) tracker.Reset();
    ContactSample sample = {{pick(), pick(), pick()}, pick()};
    for (double& load : sample.profile) load = pick();
    sample.spread = {static_cast<float>(random.Uniform(0, 1e30)), 0};
    tracker.Step(sample, t);
    for (int i = 0; i < CueCount(); ++i) {
      ASSERT_TRUE(std::isfinite(tracker.value(static_cast<Cue>(i))))
          << CueName(static_cast<Cue>(i)) << " at " << t;
    }
  }
}

// Ten million frames of one contact that repeats itself each second. Cues of a
// window return to their values; those of the whole contact are compared with
// sums in long double.
TEST(CueTest, TenMillionFramesDoNotDrift) {
  constexpr int kPeriod = 100;
  constexpr uint64_t kFrames = 10'000'000;
  std::vector<ContactSample> period;
  for (int t = 0; t < kPeriod; ++t) {
    const double wave = std::sin(2 * M_PI * t / kPeriod);
    period.push_back(
        Sample(1 + 0.1 * wave, 1e-3 * (1 + 0.2 * wave * wave),
               0.01 + 0.002 * std::cos(2 * M_PI * t / kPeriod) + 1e-3 * wave));
  }
  // Mean products of a period; the samples are exact, so these are.
  long double force = 0, motion = 0, product = 0, forces = 0, motions = 0;
  for (const ContactSample& sample : period) {
    const long double f = sample.net_force / kPeriod;
    const long double m = sample.features[static_cast<int>(Feature::kMotion)];
    force += f;
    motion += m / kPeriod;
    product += f * m;
    forces += f * sample.net_force;
    motions += m * m / kPeriod;
  }
  CueTracker tracker(100);
  const auto values = [&] {
    std::vector<double> all;
    for (const Cue cue : StandardCues()) all.push_back(tracker.value(cue));
    return all;
  };
  std::vector<double> early;
  for (uint64_t t = 1; t <= kFrames; ++t) {
    tracker.Step(period[t % kPeriod], t);
    if (t == 100 * kPeriod) early = values();
  }
  const std::vector<double> late = values();
  const std::vector<Cue> cues = StandardCues();
  for (size_t i = 0; i < cues.size(); ++i) {
    ASSERT_TRUE(std::isfinite(late[i])) << CueName(cues[i]);
    const CueGroups group = GroupOf(cues[i]);
    const bool of_all = group == GroupOf(NamedCue("log_spring")) ||
                        group == GroupOf(NamedCue("force_roughness"));
    const bool of_time =
        cues[i] == NamedCue("log_time") || cues[i] == NamedCue("log_speed");
    if (of_time || of_all) continue;
    EXPECT_NEAR(late[i], early[i], 1e-9) << CueName(cues[i]);
  }
  EXPECT_NEAR(tracker.value(NamedCue("log_time")), std::log(kFrames / 100.0),
              1e-12);
  EXPECT_NEAR(tracker.value(NamedCue("log_spring")),
              static_cast<double>(std::log(product / motions)), 1e-9);
  EXPECT_NEAR(tracker.value(NamedCue("log_slope")),
              static_cast<double>(std::log((forces - force * force) /
                                           (product - force * motion))),
              1e-8);
}

TEST(CueTest, ResetForgetsAndStepAllocatesNothing) {
  CueTracker tracker(100);
  testing::AllocationCounter counter;
  for (int t = 1; t <= 100; ++t) tracker.Step(Sample(9, 1, 1), t);
  tracker.Reset();
  for (int t = 1; t <= 7; ++t) tracker.Step(Sample(1, 1e-3, 0.001 * t), t);
  EXPECT_EQ(counter.count(), 0);
  CueTracker fresh(100);
  for (int t = 1; t <= 7; ++t) fresh.Step(Sample(1, 1e-3, 0.001 * t), t);
  for (int i = 0; i < CueCount(); ++i) {
    const Cue cue = static_cast<Cue>(i);
    EXPECT_EQ(tracker.value(cue), fresh.value(cue)) << CueName(cue);
  }
}

}  // namespace
}  // namespace tactus::internal
