#include "core/features/touched.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
namespace {

constexpr float kThreshold = 0.01F;

std::vector<float> Frame(size_t size, Random& random) {
  std::vector<float> taxels(size);
  const double density = random.Uniform();
  for (float& taxel : taxels) {
    if (random.Uniform() < density) {
      taxel = static_cast<float>(random.Uniform(0, 0.02));
    }
    if (random.Index(20) == 0) taxel = kThreshold;
    if (random.Index(50) == 0) taxel = std::numeric_limits<float>::quiet_NaN();
  }
  return taxels;
}

TEST(TouchedTest, BitsAreThoseOfAPlainLoopAtAnyWidth) {
  ForEachTarget([] {
    Random random(1);
    for (size_t size = 1; size < 300; ++size) {
      const std::vector<float> taxels = Frame(size, random);
      std::vector<uint64_t> bits(TouchedWords(size), ~uint64_t{0});
      const bool any = FindTouched(taxels, kThreshold, bits);
      bool want_any = false;
      for (size_t i = 0; i < 64 * bits.size(); ++i) {
        const bool touched = i < size && taxels[i] >= kThreshold;
        want_any |= touched;
        ASSERT_EQ(bits[i / 64] >> (i % 64) & 1, touched) << i << " of " << size;
      }
      ASSERT_EQ(any, want_any);
    }
  });
}

TEST(TouchedTest, NothingIsTouchedInAnEmptyFrame) {
  std::vector<uint64_t> bits(6);
  EXPECT_FALSE(FindTouched(std::vector<float>(384), kThreshold, bits));
}

TEST(TouchedTest, SumsAreRightAndTheSameBitsAtAnyWidth) {
  std::vector<double> first;
  ForEachTarget([&first] {
    Random random(2);
    std::vector<double> totals;
    for (size_t size = 1; size < 300; ++size) {
      const std::vector<float> taxels = Frame(size, random);
      std::vector<uint64_t> bits(TouchedWords(size));
      FindTouched(taxels, kThreshold, bits);
      for (uint64_t& word : bits) word &= random.Index(1 << 30) << 20;
      const TouchedSum sum = SumTouched(taxels, bits);
      long double total = 0;
      float largest = 0;
      TouchedAdder adder;
      for (size_t i = 0; i < size; ++i) {
        if ((bits[i / 64] >> (i % 64) & 1) == 0) continue;
        total += taxels[i];
        largest = std::max(largest, taxels[i]);
        adder.Add(taxels, i, i + 1);
      }
      ASSERT_EQ(adder.Sum().max_value, sum.max_value);
      ASSERT_EQ(adder.Sum().total, sum.total);
      ASSERT_EQ(sum.max_value, largest);
      ASSERT_NEAR(sum.total, static_cast<double>(total), 1e-15 * size);
      totals.push_back(sum.total);
    }
    if (first.empty()) first = totals;
    EXPECT_EQ(totals, first);
  });
}

}  // namespace
}  // namespace tactus::internal
