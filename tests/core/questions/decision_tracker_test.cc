#include "core/questions/decision_tracker.h"

#include <array>

#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using Pair = std::array<double, 2>;

// Steps question 0 through the probabilities of its first value, from frame 1.
std::vector<DecisionEvent> Walk(DecisionTracker& tracker,
                                const std::vector<double>& first,
                                double unknown = 0) {
  std::vector<DecisionEvent> events;
  uint64_t frame = 0;
  for (const double p : first) {
    events.push_back(tracker.Step(0, Pair{p, 1 - p}, unknown, ++frame));
    EXPECT_EQ(EventAt(tracker.decisions()[0], frame), events.back());
  }
  return events;
}

constexpr auto kNone = DecisionEvent::kNone;
constexpr auto kDecided = DecisionEvent::kDecided;
constexpr auto kChanged = DecisionEvent::kChanged;

// Made by hand: the threshold is 0.9 for 3 frames.
TEST(DecisionTrackerTest, AStateIsDecidedThenChanges) {
  DecisionTracker tracker({{Question::kState, 0.9, 3}});
  EXPECT_FALSE(tracker.decisions()[0].decided());
  const std::vector<double> first = {0.5, 0.9, 0.95, 0.89, 0.9, 0.9, 0.9,
                                     0.9, 0.5, 0.05, 0.1,  0.1, 0.1};
  EXPECT_THAT(
      Walk(tracker, first),
      ::testing::ElementsAre(kNone, kNone, kNone, kNone, kNone, kNone, kDecided,
                             kNone, kNone, kNone, kNone, kChanged, kNone));
  const QuestionDecision& decision = tracker.decisions()[0];
  EXPECT_EQ(decision.value, 1);
  EXPECT_EQ(decision.frame, 7u);
  EXPECT_EQ(decision.changed_frame, 12u);
  EXPECT_EQ(decision.changes, 1u);
  EXPECT_FALSE(decision.revised);
  tracker.Reset();
  EXPECT_FALSE(tracker.decisions()[0].decided());
  EXPECT_EQ(tracker.decisions()[0].changes, 0u);
}

TEST(DecisionTrackerTest, APropertyIsRevised) {
  DecisionTracker tracker({{Question::kProperty, 0.9, 1}});
  EXPECT_THAT(Walk(tracker, {0.95, 0.5, 0.05, 0.95}),
              ::testing::ElementsAre(kDecided, kNone, kChanged, kChanged));
  EXPECT_TRUE(tracker.decisions()[0].revised);
  EXPECT_EQ(tracker.decisions()[0].changes, 2u);
  EXPECT_EQ(tracker.decisions()[0].frame, 1u);
}

TEST(DecisionTrackerTest, AnUnknownContactIsNotDecided) {
  DecisionTracker tracker({{Question::kState, 0.9, 2}});
  EXPECT_THAT(Walk(tracker, {1, 1, 1}, 0.5),
              ::testing::ElementsAre(kNone, kNone, kNone));
  EXPECT_THAT(Walk(tracker, {1, 1}, 0.4999),
              ::testing::ElementsAre(kNone, kDecided));
}

TEST(DecisionTrackerTest, QuestionsAreDecidedApart) {
  DecisionTracker tracker(
      {{Question::kState, 0.9, 1}, {Question::kProperty, 0.6, 2}});
  for (uint64_t frame = 1; frame <= 2; ++frame) {
    tracker.Step(0, Pair{0.5, 0.5}, 0, frame);
    tracker.Step(1, Pair{0.3, 0.7}, 0, frame);
  }
  EXPECT_FALSE(tracker.decisions()[0].decided());
  EXPECT_EQ(tracker.decisions()[1].frame, 2u);
  EXPECT_EQ(tracker.decisions()[1].value, 1);
}

// Looks back over all frames at each frame, where the tracker counts.
TEST(DecisionTrackerTest, AgreesWithALookBackOverAllFrames) {
  constexpr double kThreshold = 0.6;
  constexpr size_t kFrames = 4;
  Random random(11);
  for (int contact = 0; contact < 200; ++contact) {
    DecisionTracker tracker({{Question::kState, kThreshold, kFrames}});
    std::vector<std::array<double, 3>> past;
    std::vector<bool> known;
    std::vector<std::pair<int, uint64_t>> wanted;
    std::array<double, 3> p = {};
    for (uint64_t frame = 1; frame <= 60; ++frame) {
      if (frame == 1 || random.Uniform() < 0.2) {
        const size_t top = random.Index(3);
        p.fill(0.1);
        p[top] = 0.8 - 0.3 * (random.Uniform() < 0.2);
      }
      past.push_back(p);
      known.push_back(random.Uniform() > 0.05);
      tracker.Step(0, p, known.back() ? 0.1 : 0.9, frame);
      for (int v = 0; v < 3; ++v) {
        bool all = past.size() >= kFrames;
        for (size_t back = 0; all && back < kFrames; ++back) {
          const size_t at = past.size() - 1 - back;
          all = known[at] && past[at][v] >= kThreshold;
        }
        if (all && (wanted.empty() || wanted.back().first != v)) {
          wanted.emplace_back(v, frame);
        }
      }
    }
    const QuestionDecision& decision = tracker.decisions()[0];
    ASSERT_EQ(decision.decided(), !wanted.empty());
    if (wanted.empty()) continue;
    EXPECT_EQ(decision.frame, wanted.front().second);
    EXPECT_EQ(decision.value, wanted.back().first);
    EXPECT_EQ(decision.changes, wanted.size() - 1);
    EXPECT_EQ(decision.changed_frame,
              wanted.size() > 1 ? wanted.back().second : 0);
  }
}

TEST(DecisionTrackerTest, AFrameAllocatesNothing) {
  DecisionTracker tracker(
      {{Question::kState, 0.9, 2}, {Question::kProperty, 0.9, 2}});
  const testing::AllocationCounter counter;
  for (uint64_t frame = 1; frame <= 100; ++frame) {
    const double p = frame % 20 < 10 ? 0.95 : 0.05;
    tracker.Step(0, Pair{p, 1 - p}, 0, frame);
    tracker.Step(1, Pair{p, 1 - p}, 0, frame);
  }
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
