// A stream whose frames came at another rate than its config said got answers
// without a word.
#include "core/base/rate_watch.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

// How often a watch speaks of `seconds` of frames at `hz`, in batches.
int Words(RateWatch& watch, double hz, int seconds, uint32_t batch,
          int64_t begin_ns = 0) {
  int words = 0;
  const auto frames = static_cast<int64_t>(hz * seconds);
  for (int64_t i = 0; i < frames; i += batch) {
    words += watch.Add(
        batch, begin_ns + static_cast<int64_t>(static_cast<double>(i) / hz *
                                               static_cast<double>(kSecond)));
  }
  return words;
}

TEST(RateThatNobodyComparesTest, AnotherRateIsFoundOnce) {
  for (const double hz : {50.0, 94.0, 106.0, 200.0, 5000.0}) {
    for (const uint32_t batch : {1U, 8U}) {
      RateWatch watch(100);
      EXPECT_EQ(Words(watch, hz, 20, batch), 1) << hz;
      EXPECT_TRUE(watch.differs());
      EXPECT_NEAR(watch.measured_hz(), hz, hz * 0.01);
    }
  }
}

// Microseconds in the place of nanoseconds.
TEST(RateThatNobodyComparesTest, SoIsAnotherUnit) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t i = 0; i < 1000; ++i) words += watch.Add(1, i * 10'000);
  EXPECT_EQ(words, 1);
}

TEST(RateThatNobodyComparesTest, TheStatedRateIsNoNews) {
  for (const double hz : {96.0, 100.0, 104.0}) {
    RateWatch watch(100);
    EXPECT_EQ(Words(watch, hz, 20, 1), 0) << hz;
  }
}

// A robot that stops sending for a while, or a trial that ends.
TEST(RateThatNobodyComparesTest, PausesAreNoNews) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t part = 0; part < 20; ++part) {
    words += Words(watch, 100, 3, 1, part * 10 * kSecond);
    if (part > 10) watch.Pause();
  }
  EXPECT_EQ(words, 0);
}

}  // namespace
}  // namespace tactus
