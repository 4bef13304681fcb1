#include "core/eval/question_outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/contacts/question_truth.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

const std::vector<std::string> kClasses = {"HU", "HM", "SU", "SM"};

Question Hardness() { return DefaultQuestions(kClasses)[0]; }
Question Mobility() { return DefaultQuestions(kClasses)[1]; }

// A contact at 100 Hz whose object moves 2 mm at frame `moved_at`.
LabelledContact Contact(const std::string& label, size_t frames,
                        size_t moved_at) {
  LabelledContact contact;
  contact.label = label;
  for (size_t t = 0; t < frames; ++t) {
    contact.frames.push_back_numbers({});
    contact.object_motion.push_back(t < moved_at ? 0.0005 : 0.002);
  }
  return contact;
}

// The timing of a question whose second value has these probabilities.
QuestionTiming TimingOf(const Question& question,
                        const LabelledContact& contact,
                        const std::vector<double>& second) {
  const QuestionTruth truth(question, kClasses, contact);
  QuestionWatch watch(truth, question.kind);
  for (size_t t = 0; t < second.size(); ++t) {
    const double p[] = {1 - second[t], second[t]};
    watch.Step(t, p);
  }
  return watch.Finish(contact.sample_rate_hz);
}

// Made by hand: the object moves at frame 3, the answer crosses 0.5 at frame 4,
// falls back at 6, and crosses 0.9 at 7.
TEST(QuestionWatchTest, AStateIsTimedFromItsChange) {
  const QuestionTiming timing =
      TimingOf(Mobility(), Contact("HM", 9, 3),
               {0.1, 0.2, 0.4, 0.4, 0.6, 0.8, 0.3, 0.91, 0.9});
  EXPECT_DOUBLE_EQ(*timing.from_s, 0.03);
  EXPECT_DOUBLE_EQ(*timing.delay_s, 0.04);
  EXPECT_DOUBLE_EQ(*timing.settled_s, 0.04);
  EXPECT_FALSE(timing.false_alarm);
  EXPECT_FALSE(timing.early);
}

TEST(QuestionWatchTest, AnAnswerBeforeTheChangeIsEarly) {
  const QuestionTiming timing =
      TimingOf(Mobility(), Contact("SM", 4, 2), {0.5, 0.95, 0.95, 0.95});
  EXPECT_TRUE(timing.early);
  EXPECT_EQ(*timing.delay_s, 0);
}

TEST(QuestionWatchTest, AChangeThatIsNeverSeenHasNoDelay) {
  const QuestionTiming timing =
      TimingOf(Mobility(), Contact("HM", 4, 2), {0.1, 0.1, 0.6, 0.4});
  EXPECT_TRUE(timing.from_s);
  EXPECT_FALSE(timing.delay_s);
  EXPECT_FALSE(timing.settled_s);
}

TEST(QuestionWatchTest, WhatNeverChangesCanOnlyAlarm) {
  const auto alarm = [](const std::vector<double>& second) {
    const QuestionTiming timing =
        TimingOf(Mobility(), Contact("HU", 3, 99), second);
    EXPECT_FALSE(timing.from_s);
    return timing.false_alarm;
  };
  EXPECT_EQ(alarm({0.1, 0.9, 0.1}), false);
  EXPECT_EQ(alarm({0.1, 0.91, 0.1}), true);
}

TEST(QuestionWatchTest, WithoutMotionAStateHasNoHistory) {
  LabelledContact contact = Contact("HM", 3, 1);
  contact.object_motion.clear();
  const QuestionTiming timing =
      TimingOf(Mobility(), contact, {0.1, 0.95, 0.95});
  EXPECT_FALSE(timing.from_s);
  EXPECT_FALSE(timing.false_alarm);
}

TEST(QuestionWatchTest, APropertyIsTimedFromTheOnset) {
  const QuestionTiming timing =
      TimingOf(Hardness(), Contact("SM", 5, 2), {0.05, 0.6, 0.6, 0.95, 0.95});
  EXPECT_EQ(*timing.from_s, 0);
  EXPECT_DOUBLE_EQ(*timing.delay_s, 0.03);
  EXPECT_DOUBLE_EQ(*timing.settled_s, 0.01);
  // Hard was sure at the first frame.
  EXPECT_EQ(timing.false_alarm, true);
}

// The definitions of the header in plain loops over whole contacts.
TEST(QuestionWatchTest, AgreesWithPlainLoops) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const size_t frames = 1 + random.Index(40);
    const size_t moved_at = random.Index(60);
    const bool moves = moved_at < frames;
    const LabelledContact contact =
        Contact(moves ? "HM" : "HU", frames, moved_at);
    std::vector<double> moved;
    double level = random.Uniform();
    for (size_t t = 0; t < frames; ++t) {
      level = std::clamp(level + random.Uniform(-0.3, 0.35), 0.0, 1.0);
      moved.push_back(level);
    }
    const QuestionTiming timing = TimingOf(Mobility(), contact, moved);
    ASSERT_EQ(timing.from_s.has_value(), moves);
    ASSERT_EQ(timing.false_alarm.has_value(), !moves);
    if (!moves) {
      bool alarm = false;
      for (const double p : moved) alarm |= p > 0.9;
      EXPECT_EQ(*timing.false_alarm, alarm);
      continue;
    }
    std::optional<double> delay;
    for (size_t t = frames; t-- > moved_at;) {
      if (moved[t] > 0.9) delay = static_cast<double>(t - moved_at) / 100;
    }
    std::optional<double> settled;
    for (size_t t = frames; t-- > moved_at && moved[t] > 0.5;) {
      settled = static_cast<double>(t - moved_at) / 100;
    }
    bool early = false;
    for (size_t t = 0; t < moved_at; ++t) early |= moved[t] > 0.9;
    EXPECT_EQ(timing.delay_s, delay);
    EXPECT_EQ(timing.settled_s, settled);
    EXPECT_EQ(timing.early, early);
  }
}

TEST(SummariseDelaysTest, QuantilesAreOfTheNearestRank) {
  std::vector<std::optional<double>> delays;
  for (int i = 10; i >= 1; --i) delays.emplace_back(i);
  DelaySummary summary = SummariseDelays(delays);
  EXPECT_EQ(summary.median, 5);
  EXPECT_EQ(summary.p90, 9);
  EXPECT_EQ(summary.p99, 10);
  delays[0].reset();
  delays[1].reset();
  summary = SummariseDelays(delays);
  EXPECT_EQ(summary.count, 10);
  EXPECT_EQ(summary.missed, 2);
  EXPECT_EQ(summary.median, 5);
  EXPECT_FALSE(summary.p90);
  EXPECT_FALSE(summary.p99);
  EXPECT_FALSE(SummariseDelays({}).median);
}

// The definition: the smallest delay that a fraction p of all do not exceed.
TEST(SummariseDelaysTest, AgreeWithCounting) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::optional<double>> delays(1 + random.Index(150));
    for (auto& delay : delays) {
      if (random.Uniform() < 0.93) delay = random.Index(40);
    }
    const auto quantile = [&](int percent) {
      for (int value = 0; value < 40; ++value) {
        const auto within = std::ranges::count_if(
            delays, [&](const auto& d) { return d && *d <= value; });
        if (within * 100 >= percent * std::ssize(delays)) {
          return std::optional<double>(value);
        }
      }
      return std::optional<double>();
    };
    const DelaySummary summary = SummariseDelays(delays);
    EXPECT_EQ(summary.median, quantile(50));
    EXPECT_EQ(summary.p90, quantile(90));
    EXPECT_EQ(summary.p99, quantile(99));
  }
}

TEST(SummariseTest, CountsDecisionsAlarmsAndLateChanges) {
  std::vector<QuestionOutcome> outcomes(6);
  outcomes[0].timing = {.from_s = 0.5, .delay_s = 0.1, .settled_s = 0.2};
  outcomes[1].timing = {.from_s = 1.0, .delay_s = 0.3, .early = true};
  outcomes[2].timing = {.from_s = 1.01};
  outcomes[3].timing = {.false_alarm = true};
  outcomes[4].timing = {.false_alarm = false};
  outcomes[0].decision = {.value = 1, .truth = 0};
  outcomes[1].decision = {.value = 1, .truth = 1};
  outcomes[2].decision = {.value = 0, .truth = 1};
  outcomes[1].changes = 2;
  const QuestionSummary summary = Summarise(Mobility(), outcomes);
  EXPECT_EQ(summary.delay.count, 3);
  EXPECT_EQ(summary.delay.missed, 1);
  EXPECT_EQ(summary.delay_late.count, 1);
  EXPECT_EQ(summary.settled.missed, 2);
  EXPECT_EQ(summary.watched, 2);
  EXPECT_EQ(summary.false_alarms, 1);
  EXPECT_EQ(summary.early, 1);
  EXPECT_EQ(summary.made, 3);
  EXPECT_EQ(summary.right, 1);
  EXPECT_EQ(summary.changed, 1);
  EXPECT_EQ(summary.constant_value, 1);
  EXPECT_EQ(summary.constant_right, 2);
}

}  // namespace
}  // namespace tactus::internal
