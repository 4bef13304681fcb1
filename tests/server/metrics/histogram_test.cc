#include "server/metrics/histogram.h"

#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(HistogramTest, CountsUpToEachBound) {
  constexpr std::array kBounds = {1.0, 2.0, 4.0};
  Histogram histogram(kBounds);
  histogram.Observe(0.5);
  histogram.Observe(1.0);  // a bound belongs to what is below it
  histogram.Observe(1.5, 3);
  histogram.Observe(100);
  Histogram::Data data = histogram.Read();
  EXPECT_EQ(data.at_most, (std::vector<uint64_t>{2, 5, 5}));
  EXPECT_EQ(data.count, 6u);
  EXPECT_DOUBLE_EQ(data.sum, 0.5 + 1 + 4.5 + 100);
  Histogram::Data sum;
  sum.Add(data);
  sum.Add(data);
  EXPECT_EQ(sum.at_most, (std::vector<uint64_t>{4, 10, 10}));
  EXPECT_EQ(sum.count, 12u);
}

}  // namespace
}  // namespace tactus::internal::server
