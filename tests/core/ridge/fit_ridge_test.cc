#include "core/ridge/fit_ridge.h"

#include <cmath>
#include <memory>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/ridge/ridge_samples.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using testing::Frames;
using testing::Views;

constexpr int kRows = 2;
constexpr int kColumns = 4;

// Contacts of which class k presses column k hardest; `noise` blurs that.
struct Touches {
  std::vector<std::unique_ptr<Frames>> frames;
  std::vector<HistorySample> samples;
};

Touches MakeTouches(int classes, int of_each, double noise, uint64_t seed) {
  Random random(seed);
  Touches touches;
  for (int i = 0; i < classes * of_each; ++i) {
    const int label = i % classes;
    auto frames = std::make_unique<Frames>(30 + random.Index(30));
    for (auto& frame : *frames) {
      for (uint32_t taxel = 0; taxel < kRows * kColumns; ++taxel) {
        const bool pressed = static_cast<int>(taxel % kColumns) == label;
        const double root =
            1 + (pressed ? 1.0 : 0.0) + noise * random.Gaussian();
        if (root > 0.2) frame.push_back({taxel, static_cast<float>(root)});
      }
    }
    touches.samples.push_back(
        {.frames = Views(*frames), .label = label, .group = i / classes % 5});
    touches.frames.push_back(std::move(frames));
  }
  return touches;
}

RidgeOptions OptionsFor(int classes) {
  return {.shape = {kRows, kColumns}, .classes = classes};
}

int RightOf(const Ridge& ridge, const Touches& touches) {
  RidgeScorer scorer(&ridge);
  std::vector<double> scores(ridge.classes());
  int right = 0;
  for (const HistorySample& sample : touches.samples) {
    scorer.Reset();
    for (const auto frame : sample.frames) scorer.Step(frame);
    scorer.Score(scores);
    right += std::ranges::max_element(scores) - scores.begin() == sample.label;
  }
  return right;
}

TEST(FitRidgeTest, AnswersToContactsThatItHasNotSeen) {
  const Touches training = MakeTouches(3, 10, 1.5, 1);
  const Touches others = MakeTouches(3, 50, 1.5, 2);
  const auto ridge = FitRidge(training.samples, OptionsFor(3));
  ASSERT_TRUE(ridge.ok()) << ridge.status();
  EXPECT_TRUE(Validate(*ridge).ok()) << Validate(*ridge);
  EXPECT_GE(RightOf(*ridge, others), 145);
}

// At the minimum of |y - Z w|^2 + penalty |w|^2, Z^T (y - Z w) = penalty w,
// whatever the penalty is. So many contacts that their kernel matrix is made in
// several parts.
TEST(FitRidgeTest, IsAtTheMinimum) {
  const Touches touches = MakeTouches(3, 30, 1.5, 3);
  const auto ridge = FitRidge(touches.samples, OptionsFor(3));
  ASSERT_TRUE(ridge.ok());
  const size_t numbers = ridge->offset.size();
  const size_t channels = size_t{kRows * kColumns + 1} * kFrameViews;
  const auto block = [&](size_t i) {
    const size_t statistics = channels * kHistoryStatistics;
    const size_t stretches = channels * kHistoryStretches;
    const size_t size = i < statistics ? statistics
                        : i < statistics + stretches
                            ? stretches
                            : numbers - statistics - stretches;
    return 1 / std::sqrt(static_cast<double>(size));
  };
  std::vector<double> gradient(numbers);
  TouchHistory history(&ridge->history);
  std::vector<float> row(numbers);
  for (const HistorySample& sample : touches.samples) {
    for (const double part : {0.25, 0.5, 1.0}) {
      history.Reset();
      const auto end =
          std::lround(part * static_cast<double>(sample.frames.size()));
      for (int t = 0; t < end; ++t) history.Step(sample.frames[t]);
      history.Write(row);
      std::vector<double> z(numbers);
      double answer = ridge->bias[0];
      for (size_t i = 0; i < numbers; ++i) {
        z[i] = std::clamp((row[i] - ridge->offset[i]) * ridge->gain[i],
                          -kRidgeLimit, kRidgeLimit) *
               block(i);
        answer += z[i] * ridge->weight[i] / block(i);
      }
      const double error = (sample.label == 0 ? 1 : 0) - answer;
      for (size_t i = 0; i < numbers; ++i) gradient[i] += error * z[i];
    }
  }
  double both = 0;
  double weights = 0;
  double gradients = 0;
  for (size_t i = 0; i < numbers; ++i) {
    const double weight = ridge->weight[i] / block(i);
    both += gradient[i] * weight;
    weights += weight * weight;
    gradients += gradient[i] * gradient[i];
  }
  EXPECT_GT(both, 0);
  // The answers and the weights are rounded to float, and what is left of the
  // answers' errors is small.
  EXPECT_GT(both / std::sqrt(weights * gradients), 0.998);
}

TEST(FitRidgeTest, GivesTheSameBits) {
  const Touches touches = MakeTouches(2, 6, 1, 4);
  const auto once = FitRidge(touches.samples, OptionsFor(2));
  const auto again = FitRidge(touches.samples, OptionsFor(2));
  RidgeOptions other = OptionsFor(2);
  other.seed = 2;
  const auto seeded = FitRidge(touches.samples, other);
  ASSERT_TRUE(once.ok() && again.ok() && seeded.ok());
  EXPECT_EQ(once->weight, again->weight);
  EXPECT_EQ(once->history.threshold, again->history.threshold);
  EXPECT_NE(once->history.mixed_channel, seeded->history.mixed_channel);
}

TEST(FitRidgeTest, PoorDataGiveFiniteAnswers) {
  // Equal contacts, of one frame, in one group, and classes of one contact.
  Touches touches = MakeTouches(2, 1, 0, 5);
  for (HistorySample& sample : touches.samples) {
    sample.frames.resize(1);
    sample.group = 0;
  }
  touches.samples.push_back(touches.samples[0]);
  touches.samples.push_back(touches.samples[0]);
  touches.samples.back().label = 1;
  const auto ridge = FitRidge(touches.samples, OptionsFor(2));
  ASSERT_TRUE(ridge.ok()) << ridge.status();
  EXPECT_TRUE(Validate(*ridge).ok()) << Validate(*ridge);
  RightOf(*ridge, touches);
  // Nothing differs from contact to contact.
  for (HistorySample& sample : touches.samples) {
    sample.frames = touches.samples[0].frames;
  }
  const auto constant = FitRidge(touches.samples, OptionsFor(2));
  ASSERT_TRUE(constant.ok()) << constant.status();
  EXPECT_TRUE(Validate(*constant).ok()) << Validate(*constant);
}

TEST(FitRidgeTest, CanBeEndedAtAnyQuestion) {
  const Touches touches = MakeTouches(2, 40, 1, 6);
  RidgeOptions options = OptionsFor(2);
  int questions = 0;
  int end_at = 0;
  options.go_on = [&] {
    return ++questions == end_at ? absl::CancelledError("enough")
                                 : absl::OkStatus();
  };
  ASSERT_TRUE(FitRidge(touches.samples, options).ok());
  const int all = questions;
  // One for each contact, and some for the matrix and the penalties.
  EXPECT_GT(all, 85);
  for (end_at = 1; end_at <= all; end_at += 7) {
    questions = 0;
    EXPECT_EQ(FitRidge(touches.samples, options).status().message(), "enough")
        << end_at;
    EXPECT_EQ(questions, end_at);
  }
}

TEST(RidgeTest, WrongPartsAreNamed) {
  const Touches touches = MakeTouches(2, 4, 1, 7);
  const auto good = FitRidge(touches.samples, OptionsFor(2));
  ASSERT_TRUE(good.ok());
  const auto refused = [&](const auto& change, const char* what) {
    Ridge ridge = *good;
    change(ridge);
    EXPECT_THAT(Validate(ridge).message(), ::testing::HasSubstr(what));
  };
  refused([](auto& r) { r.offset.pop_back(); }, "offsets of the ridge");
  refused([](auto& r) { r.gain[3] = std::nanf(""); }, "gains of the ridge");
  refused([](auto& r) { r.weight.pop_back(); }, "weights of the ridge");
  refused([](auto& r) { r.weight[3] = 1e30F; }, "weights of the ridge");
  refused([](auto& r) { r.bias[0] = HUGE_VALF; }, "biases of the ridge");
  refused([](auto& r) { r.history.block = 3; }, "block of the history");
}

TEST(RidgeTest, ScoringAllocatesNothing) {
  const Touches touches = MakeTouches(2, 4, 1, 8);
  const auto ridge = FitRidge(touches.samples, OptionsFor(2));
  ASSERT_TRUE(ridge.ok());
  RidgeScorer scorer(&*ridge);
  std::vector<double> scores(2);
  const testing::AllocationCounter counter;
  for (const auto frame : touches.samples[0].frames) {
    scorer.Step(frame);
    scorer.Score(scores);
  }
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
