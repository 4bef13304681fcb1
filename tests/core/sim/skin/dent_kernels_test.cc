#include "core/sim/skin/dent_kernels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
namespace {

// The dent of one strip of width 1, at the depth in its middle.
struct Section {
  double volume = 0;
  double area = 0;
};

Section CutOne(const dent_kernels::Dent& dent, double depth) {
  if (depth <= 0) return {};
  double low = dent.low;
  double high = dent.high;
  if (dent.curvature > 0) {
    const double half = std::sqrt(depth / dent.curvature);
    low = std::max(low, -half);
    high = std::min(high, half);
  }
  if (high <= low) return {};
  return {
      depth * (high - low) -
          dent.curvature * (high * high * high - low * low * low) / 3,
      high - low,
  };
}

// On flat skins and on curved ones, where strips are not reached, and where a
// dent ends between `low` and `high` or lies beside them.
TEST(DentKernelsTest, CutWhatOneStripAtATimeCuts) {
  ForEachTarget([] {
    Random random(1);
    constexpr size_t kStrips = 2 * dent_kernels::kStrips;
    std::vector<double> places(kStrips);
    std::vector<double> widths(kStrips);
    std::vector<double> volumes(kStrips);
    std::vector<double> areas(kStrips);
    int dented = 0;
    for (int n = 0; n < 1'000; ++n) {
      for (double& place : places) place = random.Uniform(-0.1, 0.1);
      for (double& width : widths) width = random.Uniform(0, 0.01);
      const double low = random.Uniform(-0.02, 0.02);
      const dent_kernels::Dent dent = {
          .depth = random.Uniform(-0.0005, 0.001),
          .rise = n % 2 == 0 ? 0 : random.Uniform(-0.02, 0.02),
          .curvature = n % 3 == 0 ? 0 : random.Uniform(1, 100),
          .low = low,
          .high = low + random.Uniform(0, 0.02)};
      dent_kernels::Cut(dent, places, widths.data(), volumes.data(),
                        areas.data());
      for (size_t i = 0; i < kStrips; ++i) {
        const Section section =
            CutOne(dent, dent.depth + places[i] * dent.rise);
        ASSERT_EQ(volumes[i], widths[i] * section.volume);
        ASSERT_EQ(areas[i], widths[i] * section.area);
        dented += section.area > 0;
      }
    }
    EXPECT_GT(dented, 4'000);
    EXPECT_LT(dented, 12'000);
  });
}

}  // namespace
}  // namespace tactus::internal
