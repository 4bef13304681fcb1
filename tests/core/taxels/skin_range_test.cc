#include "core/taxels/skin_range.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

// Three taxels: up to 1, from 2 to 4, never touched.
const SkinRange kRange = {{0, 2, 0}, {1, 4, 0}};

// A contact of two frames with these mean loads.
bool Contact(SkinRangeWatch& watch, std::vector<float> loads) {
  for (const float factor : {0.5F, 1.5F}) {
    std::vector<TaxelLoad> touched;
    for (uint32_t i = 0; i < loads.size(); ++i) {
      if (loads[i] > 0) touched.push_back({i, std::sqrt(factor * loads[i])});
    }
    watch.Step(touched);
  }
  return watch.EndContact();
}

TEST(SkinRangeWatchTest, KnownReadingsSayNothing) {
  SkinRangeWatch watch(&kRange);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(Contact(watch, {static_cast<float>(random.Uniform(0, 1)),
                                 static_cast<float>(random.Uniform(2, 4)), 0}));
  }
}

TEST(SkinRangeWatchTest, ATaxelThatDiffersInARowIsTold) {
  for (const auto& [loads, taxel] :
       {std::pair(std::vector<float>{0.5F, 0, 0}, 1U),     // dead
        std::pair(std::vector<float>{0.5F, 3, 2}, 2U),     // stuck
        std::pair(std::vector<float>{0.5F, 9, 0}, 1U)}) {  // another gain
    SkinRangeWatch watch(&kRange);
    for (int i = 0; i < SkinRangeWatch::kContacts - 1; ++i) {
      EXPECT_FALSE(Contact(watch, loads));
    }
    EXPECT_TRUE(Contact(watch, loads));
    ASSERT_EQ(watch.differing().size(), 1u);
    EXPECT_EQ(watch.differing()[0].taxel, taxel);
    EXPECT_NEAR(watch.differing()[0].load, loads[taxel], 1e-5);
    // Once.
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(Contact(watch, loads));
  }
}

TEST(SkinRangeWatchTest, AContactInBetweenStartsTheRowAgain) {
  SkinRangeWatch watch(&kRange);
  for (int i = 0; i < 100; ++i) {
    const bool known = i % SkinRangeWatch::kContacts == 0;
    EXPECT_FALSE(Contact(watch, {0.5F, known ? 3.0F : 30.0F, 0}));
  }
}

TEST(SkinRangeWatchTest, TheMostDistantTaxelComesFirst) {
  SkinRangeWatch watch(&kRange);
  bool told = false;
  for (int i = 0; i < 10 && !told; ++i) told = Contact(watch, {9, 0, 90});
  ASSERT_TRUE(told);
  ASSERT_EQ(watch.differing().size(), 3u);
  EXPECT_EQ(watch.differing()[0].taxel, 2u);
  EXPECT_EQ(watch.differing()[1].taxel, 0u);
}

TEST(SkinRangeWatchTest, AContactWithoutFramesIsNone) {
  SkinRangeWatch watch(&kRange);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(watch.EndContact());
}

TEST(SkinRangeWatchTest, AllocatesNothing) {
  SkinRangeWatch watch(&kRange);
  const TaxelLoad loads[] = {{0, 9}, {2, 9}};
  const testing::AllocationCounter counter;
  for (int i = 0; i < 10; ++i) {
    watch.Step(loads);
    watch.EndContact();
  }
  EXPECT_EQ(counter.count(), 0);
  EXPECT_FALSE(watch.differing().empty());
}

TEST(SkinRangeTest, BrokenRangesAreRefused) {
  EXPECT_TRUE(Validate(kRange, 3).ok());
  const auto refused = [](const SkinRange& range) {
    return ReasonOf(Validate(range, 3)) == "INVALID_MODEL";
  };
  EXPECT_EQ(ReasonOf(Validate(kRange, 4)), "INVALID_MODEL");
  EXPECT_TRUE(refused({{0, 2}, {1, 4, 0}}));
  EXPECT_TRUE(refused({{0, 5, 0}, {1, 4, 0}}));
  EXPECT_TRUE(refused({{-1, 2, 0}, {1, 4, 0}}));
  EXPECT_TRUE(refused({{0, 2, 0}, {1, INFINITY, 0}}));
  EXPECT_TRUE(refused({{0, NAN, 0}, {1, 4, 0}}));
}

}  // namespace
}  // namespace tactus::internal
