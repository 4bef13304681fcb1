#include "core/base/gaussian.h"

#include <cmath>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/base/crc32c.h"
#include "gtest/gtest.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
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

// The bits of the implementation before Highway, in plain C++: models were
// trained on these numbers.
TEST(FillGaussianTest, KeepsItsBits) {
  ForEachTarget([] {
    Random random(7);
    std::vector<double> deviates(10'001);
    FillGaussian(random, deviates);
    const absl::string_view bytes(
        reinterpret_cast<const char*>(deviates.data()),
        deviates.size() * sizeof(double));
    EXPECT_EQ(ExtendCrc32c(0, bytes), 0x047801b9u);
  });
}

}  // namespace
}  // namespace tactus::internal
