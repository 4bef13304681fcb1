#include "core/nearest/nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/errors.h"
#include "core/nearest/fit_nearest.h"
#include "gtest/gtest.h"
#include "tests/core/ridge/ridge_samples.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using testing::Frames;
using testing::Views;

constexpr int kRows = 2;
constexpr int kColumns = 4;
constexpr int kTaxels = kRows * kColumns;

// Contacts of 40 frames of which class k presses column k hardest. The load of
// all taxels together says nothing.
struct Touches {
  std::vector<std::unique_ptr<Frames>> frames;
  std::vector<HistorySample> samples;
};

Touches MakeTouches(int classes, int of_each, uint64_t seed) {
  Random random(seed);
  Touches touches;
  for (int i = 0; i < classes * of_each; ++i) {
    const int label = i % classes;
    const double strength = random.Uniform(0.3, 30);
    auto frames = std::make_unique<Frames>(40);
    for (auto& frame : *frames) {
      for (uint32_t taxel = 0; taxel < kTaxels; ++taxel) {
        const bool pressed = static_cast<int>(taxel % kColumns) == label;
        frame.push_back(
            {taxel, static_cast<float>(strength * ((pressed ? 2 : 1) +
                                                   0.3 * random.Uniform()))});
      }
    }
    touches.samples.push_back(
        {.frames = Views(*frames), .label = label, .group = i / classes % 5});
    touches.frames.push_back(std::move(frames));
  }
  return touches;
}

NearestOptions OptionsFor(int classes) {
  return {.shape = {kRows, kColumns}, .classes = classes};
}

// The means of a view over ten stretches of a contact of 10 n frames.
std::vector<double> PlainMeans(const Frames& frames, const FrameViews& views,
                               int view) {
  std::vector<double> means;
  const size_t length = frames.size() / 10;
  for (size_t j = 0; j < 10; ++j) {
    std::vector<double> sum(kTaxels + 1);
    for (size_t t = j * length; t < (j + 1) * length; ++t) {
      double whole = 0;
      for (const TaxelLoad& load : frames[t]) {
        whole += static_cast<double>(load.root) * load.root;
      }
      for (const TaxelLoad& load : frames[t]) {
        const double root = load.root;
        const double channel[] = {root * root, root, root / std::sqrt(whole)};
        sum[load.taxel] += channel[view];
      }
      const double all[] = {whole, std::sqrt(whole), std::log(whole)};
      sum[kTaxels] += all[view];
    }
    for (const double x : sum) {
      means.push_back(x * static_cast<double>(views.scale[view]) /
                      static_cast<double>(length));
    }
  }
  return means;
}

TEST(NearestTest, AnswersToContactsOfOtherStrength) {
  const Touches training = MakeTouches(3, 10, 1);
  const Touches others = MakeTouches(3, 50, 2);
  const auto nearest = FitNearest(training.samples, OptionsFor(3));
  ASSERT_TRUE(nearest.ok()) << nearest.status();
  EXPECT_TRUE(Validate(*nearest).ok()) << Validate(*nearest);
  // Only in this view strength is one number of nine.
  EXPECT_EQ(nearest->view, 2);
  NearestScorer scorer(&*nearest);
  std::vector<double> scores(3);
  for (const size_t frames : {10, 40}) {
    int right = 0;
    for (const HistorySample& sample : others.samples) {
      scorer.Reset();
      for (size_t t = 0; t < frames; ++t) scorer.Step(sample.frames[t]);
      scorer.Score(scores);
      right +=
          std::ranges::max_element(scores) - scores.begin() == sample.label;
    }
    EXPECT_GE(right, 145) << frames;
  }
}

TEST(NearestTest, ScoresAreLogarithmsOfSquaredDistances) {
  const Touches training = MakeTouches(2, 5, 3);
  const Touches other = MakeTouches(2, 1, 4);
  const auto nearest = FitNearest(training.samples, OptionsFor(2));
  ASSERT_TRUE(nearest.ok());
  NearestScorer scorer(&*nearest);
  for (const auto frame : other.samples[0].frames) scorer.Step(frame);
  std::vector<double> scores(2);
  scorer.Score(scores);

  const auto means =
      PlainMeans(*other.frames[0], nearest->views, nearest->view);
  const size_t numbers = nearest->numbers();
  ASSERT_EQ(means.size(), numbers);
  std::vector<double> least(2, std::numeric_limits<double>::infinity());
  for (size_t s = 0; s < nearest->label.size(); ++s) {
    double distance = 0;
    for (size_t i = 0; i < numbers; ++i) {
      const double apart =
          means[i] * static_cast<double>(nearest->gain[i]) -
          static_cast<double>(nearest->sample[s * numbers + i]);
      distance += apart * apart;
    }
    double& of_class = least[nearest->label[s]];
    of_class = std::min(of_class, distance);
  }
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(scores[k], -std::log(least[k] + 1e-3), 1e-5) << k;
  }
}

TEST(NearestTest, ARecordedContactHasADistanceOfZero) {
  const Touches training = MakeTouches(2, 5, 5);
  const auto nearest = FitNearest(training.samples, OptionsFor(2));
  ASSERT_TRUE(nearest.ok());
  NearestScorer scorer(&*nearest);
  for (const auto frame : training.samples[3].frames) scorer.Step(frame);
  std::vector<double> scores(2);
  scorer.Score(scores);
  EXPECT_EQ(scores[training.samples[3].label], -std::log(1e-3));
  // Others are about 1 away: that is what the gain is for.
  EXPECT_LT(scores[1 - training.samples[3].label], -std::log(0.5));
}

TEST(NearestTest, TheLargestLoadsHaveAFiniteDistance) {
  const Touches training = MakeTouches(2, 5, 10);
  Nearest nearest = *FitNearest(training.samples, OptionsFor(2));
  std::ranges::fill(nearest.gain, 1e9F);
  ASSERT_TRUE(Validate(nearest).ok());
  NearestScorer scorer(&nearest);
  const TaxelLoad largest[] = {{0, 1e6F}, {7, 1e6F}};
  scorer.Step(largest);
  std::vector<double> scores(2);
  scorer.Score(scores);
  for (const double score : scores) EXPECT_TRUE(std::isfinite(score)) << score;
}

TEST(NearestTest, StepsAndScoresAllocateNothing) {
  const Touches training = MakeTouches(2, 5, 6);
  const auto nearest = FitNearest(training.samples, OptionsFor(2));
  ASSERT_TRUE(nearest.ok());
  NearestScorer scorer(&*nearest);
  std::vector<double> scores(2);
  const testing::AllocationCounter counter;
  for (const auto frame : training.samples[0].frames) {
    scorer.Step(frame);
    scorer.Score(scores);
  }
  scorer.Reset();
  EXPECT_EQ(counter.count(), 0);
}

TEST(NearestTest, EqualAndConstantContactsAreFitted) {
  Touches touches = MakeTouches(2, 3, 7);
  for (size_t i = 2; i < touches.samples.size(); ++i) {
    touches.samples[i].frames = touches.samples[i % 2].frames;
  }
  const auto nearest = FitNearest(touches.samples, OptionsFor(2));
  ASSERT_TRUE(nearest.ok()) << nearest.status();
  EXPECT_TRUE(Validate(*nearest).ok()) << Validate(*nearest);
}

TEST(NearestTest, TooManyNumbersAreRefused) {
  Touches touches = MakeTouches(2, 1, 8);
  std::vector<HistorySample> many;
  for (int i = 0; i < 1000; ++i) many.push_back(touches.samples[i % 2]);
  const auto nearest = FitNearest(many, {.shape = {20, 20}, .classes = 2});
  EXPECT_EQ(ReasonOf(nearest.status()), "INVALID_TRAINING_DATA");
}

TEST(NearestTest, BrokenModelsAreRefused) {
  const Touches training = MakeTouches(2, 3, 9);
  const Nearest good = *FitNearest(training.samples, OptionsFor(2));
  const auto refused = [&](const auto& damage) {
    Nearest broken = good;
    damage(broken);
    return ReasonOf(Validate(broken)) == "INVALID_MODEL";
  };
  EXPECT_TRUE(refused([](Nearest& n) { n.view = 3; }));
  EXPECT_TRUE(refused([](Nearest& n) { n.gain.pop_back(); }));
  EXPECT_TRUE(refused([](Nearest& n) { n.sample.pop_back(); }));
  EXPECT_TRUE(refused([](Nearest& n) { n.label.pop_back(); }));
  EXPECT_TRUE(refused([](Nearest& n) { n.label[0] = 2; }));
  EXPECT_TRUE(refused([](Nearest& n) { n.classes = 3; }));
  EXPECT_TRUE(refused([](Nearest& n) { n.sample[0] = NAN; }));
  EXPECT_TRUE(refused([](Nearest& n) { n.gain[0] = 1e10F; }));
  EXPECT_TRUE(refused([](Nearest& n) { n.views.rows = 0; }));
}

}  // namespace
}  // namespace tactus::internal
