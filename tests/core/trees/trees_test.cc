#include "core/trees/trees.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/errors.h"
#include "core/trees/fit_trees.h"
#include "gtest/gtest.h"
#include "tests/core/ridge/ridge_samples.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using testing::Frames;
using testing::Views;

constexpr int kRows = 2;
constexpr int kColumns = 4;

// Contacts of 40 frames. Two of eight taxels are pressed, and only whether both
// or one of them is pressed hard tells the class: no number alone does.
struct Touches {
  std::vector<std::unique_ptr<Frames>> frames;
  std::vector<HistorySample> samples;
};

Touches MakeTouches(int count, uint64_t seed) {
  Random random(seed);
  Touches touches;
  for (int i = 0; i < count; ++i) {
    const bool first = random.Index(2) == 0;
    const bool second = random.Index(2) == 0;
    auto frames = std::make_unique<Frames>(40);
    for (auto& frame : *frames) {
      for (const auto& [taxel, hard] : {std::pair(1U, first), {6U, second}}) {
        frame.push_back({taxel, static_cast<float>((hard ? 2 : 1) +
                                                   0.3 * random.Uniform())});
      }
    }
    touches.samples.push_back({.frames = Views(*frames),
                               .label = first == second ? 0 : 1,
                               .group = i % 5});
    touches.frames.push_back(std::move(frames));
  }
  return touches;
}

TreesOptions Options() {
  return {.shape = {kRows, kColumns}, .classes = 2, .trees = 100};
}

TEST(TreesTest, FindWhatNoNumberTellsAlone) {
  const Touches training = MakeTouches(80, 1);
  const Touches others = MakeTouches(200, 2);
  const auto trees = FitTrees(training.samples, Options());
  ASSERT_TRUE(trees.ok()) << trees.status();
  EXPECT_TRUE(Validate(*trees).ok()) << Validate(*trees);
  EXPECT_EQ(trees->root.size(), 100u);
  TreesScorer scorer(&*trees);
  std::vector<double> scores(2);
  int right = 0;
  for (const HistorySample& sample : others.samples) {
    scorer.Reset();
    for (const auto frame : sample.frames) scorer.Step(frame);
    scorer.Score(scores);
    EXPECT_NEAR(scores[0] + scores[1], 1, 1e-12);
    right += (scores[1] > scores[0]) == (sample.label == 1);
  }
  EXPECT_GE(right, 195);
}

// Leaves of one class: every tree knows all that it was grown from.
TEST(TreesTest, EveryTreeVotesForTheClassOfItsOwnContacts) {
  const Touches training = MakeTouches(40, 3);
  const auto trees = FitTrees(training.samples, Options());
  ASSERT_TRUE(trees.ok());
  TreesScorer scorer(&*trees);
  std::vector<double> scores(2);
  for (const HistorySample& sample : training.samples) {
    scorer.Reset();
    for (size_t t = 0; t < sample.frames.size(); ++t) {
      scorer.Step(sample.frames[t]);
      // A quarter, a half, all.
      if (t + 1 != 10 && t + 1 != 20 && t + 1 != 40) continue;
      scorer.Score(scores);
      EXPECT_EQ(scores[sample.label], 1) << t;
    }
  }
}

TEST(TreesTest, TheSeedDecidesAllBits) {
  const Touches training = MakeTouches(40, 4);
  TreesOptions options = Options();
  const Trees one = *FitTrees(training.samples, options);
  const Trees again = *FitTrees(training.samples, options);
  EXPECT_EQ(one.number, again.number);
  EXPECT_EQ(one.threshold, again.threshold);
  options.seed = 2;
  EXPECT_NE(one.threshold, FitTrees(training.samples, options)->threshold);
}

TEST(TreesTest, EqualContactsOfTwoClassesEndInALeaf) {
  Touches touches = MakeTouches(6, 5);
  for (size_t i = 0; i < touches.samples.size(); ++i) {
    touches.samples[i].frames = touches.samples[0].frames;
    // Four of class 1.
    touches.samples[i].label = i < 4 ? 1 : 0;
  }
  const auto trees = FitTrees(touches.samples, Options());
  ASSERT_TRUE(trees.ok()) << trees.status();
  EXPECT_TRUE(Validate(*trees).ok()) << Validate(*trees);
  TreesScorer scorer(&*trees);
  for (const auto frame : touches.samples[0].frames) scorer.Step(frame);
  std::vector<double> scores(2);
  scorer.Score(scores);
  EXPECT_EQ(scores[1], 1);
}

TEST(TreesTest, StepsAndScoresAllocateNothing) {
  const Touches training = MakeTouches(20, 6);
  const auto trees = FitTrees(training.samples, Options());
  ASSERT_TRUE(trees.ok());
  TreesScorer scorer(&*trees);
  std::vector<double> scores(2);
  const testing::AllocationCounter counter;
  for (const auto frame : training.samples[0].frames) {
    scorer.Step(frame);
    scorer.Score(scores);
  }
  scorer.Reset();
  EXPECT_EQ(counter.count(), 0);
}

TEST(TreesTest, BrokenTreesAreRefused) {
  const Touches training = MakeTouches(20, 7);
  const Trees good = *FitTrees(training.samples, Options());
  const auto split = static_cast<size_t>(
      std::ranges::find_if(good.number, [](int32_t n) { return n >= 0; }) -
      good.number.begin());
  const auto leaf = static_cast<size_t>(
      std::ranges::find_if(good.number, [](int32_t n) { return n < 0; }) -
      good.number.begin());
  const auto refused = [&](const auto& damage) {
    Trees broken = good;
    damage(broken);
    return ReasonOf(Validate(broken)) == "INVALID_MODEL";
  };
  EXPECT_TRUE(refused([&](Trees& t) { t.number[leaf] = -3; }));
  EXPECT_TRUE(refused([&](Trees& t) {
    t.number[split] = static_cast<int32_t>(t.history.numbers());
  }));
  EXPECT_TRUE(refused([&](Trees& t) { t.threshold[split] = NAN; }));
  // A loop, and a way into another tree.
  EXPECT_TRUE(refused([&](Trees& t) { t.child[split] = split; }));
  EXPECT_TRUE(refused([&](Trees& t) { t.child[split] = t.root[1] - 1; }));
  EXPECT_TRUE(refused([&](Trees& t) { t.child.pop_back(); }));
  EXPECT_TRUE(refused([&](Trees& t) { t.root.clear(); }));
  EXPECT_TRUE(refused([&](Trees& t) { t.root[0] = 1; }));
  EXPECT_TRUE(refused([&](Trees& t) { t.root[1] = t.root[2]; }));
  EXPECT_TRUE(refused([&](Trees& t) { t.root.back() = 1U << 30; }));
  EXPECT_TRUE(refused([&](Trees& t) {
    Random random(1);
    t.history = testing::RandomSpec(kRows, kColumns, random);
  }));
}

}  // namespace
}  // namespace tactus::internal
