#include "core/base/gaussian.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace tactus {
namespace {

// The standard library's logarithm, sine and cosine.
TEST(FillGaussianTest, DrawsWhatOneAtATimeDraws) {
  for (size_t count : {1, 2, 127, 128, 129, 100'000}) {
    Random one(7);
    Random many(7);
    std::vector<double> deviates(count);
    FillGaussian(many, deviates);
    double largest = 0;
    for (double deviate : deviates) {
      const double want = one.Gaussian();
      ASSERT_NEAR(deviate, want, 5e-15);
      largest = std::max(largest, std::abs(want));
    }
    EXPECT_GT(largest, count > 1000 ? 4 : 0);
    // The generator is where an even number of them leaves it.
    EXPECT_EQ(many.Uniform(), one.Uniform());
  }
}

}  // namespace
}  // namespace tactus
