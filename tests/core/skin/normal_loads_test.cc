#include "core/skin/normal_loads.h"

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// 3 x 4 taxels.
SkinLayout Layout(int axes, std::optional<int> normal_axis) {
  SkinLayout layout;
  layout.name = "mine";
  layout.rows = 3;
  layout.columns = 4;
  layout.axes = axes;
  layout.normal_axis = normal_axis;
  layout.signed_values = true;
  return layout;
}

std::vector<float> Values(const SkinLayout& layout) {
  Random random(3);
  std::vector<float> values(layout.values());
  for (float& value : values) value = static_cast<float>(random.Gaussian());
  return values;
}

TEST(NormalLoadsTest, UnsignedValuesOfOneAxisAreTheLoads) {
  SkinLayout layout = Layout(1, std::nullopt);
  layout.signed_values = false;
  const std::vector<float> values = Values(layout);
  NormalLoads loads(layout);
  // Not even copied.
  EXPECT_EQ(loads.Of(values).data(), values.data());
  EXPECT_EQ(loads.Of(values).size(), values.size());
}

TEST(NormalLoadsTest, TheNormalAxisIsClampedAtZero) {
  for (const int axes : {1, 3}) {
    for (int normal = 0; normal < axes; ++normal) {
      const SkinLayout layout = Layout(axes, normal);
      const std::vector<float> values = Values(layout);
      NormalLoads loads(layout);
      const std::span<const float> found = loads.Of(values);
      ASSERT_EQ(found.size(), 12U);
      for (int taxel = 0; taxel < 12; ++taxel) {
        const float value = values[taxel * axes + normal];
        EXPECT_EQ(found[taxel], value > 0 ? value : 0) << taxel;
      }
    }
  }
}

TEST(NormalLoadsTest, WithoutANormalAxisTheLoadIsTheDistance) {
  const SkinLayout layout = Layout(3, std::nullopt);
  const std::vector<float> values = Values(layout);
  NormalLoads loads(layout);
  const std::span<const float> found = loads.Of(values);
  ASSERT_EQ(found.size(), 12U);
  for (size_t taxel = 0; taxel < 12; ++taxel) {
    const float* v = &values[3 * taxel];
    EXPECT_FLOAT_EQ(found[taxel], std::hypot(v[0], v[1], v[2])) << taxel;
  }
  const SkinLayout line = Layout(1, std::nullopt);
  const std::vector<float> signs = Values(line);
  NormalLoads sizes(line);
  for (size_t taxel = 0; taxel < 12; ++taxel) {
    EXPECT_EQ(sizes.Of(signs)[taxel], std::abs(signs[taxel]));
  }
}

TEST(SumShearTest, SumsTheTwoOtherAxesOfTheTaxels) {
  const std::vector<uint64_t> rows = {0b0101, 0, 0b1000};
  constexpr int kTaxels[] = {0, 2, 11};
  // The normal axis, and the two that are not.
  constexpr int kAxes[][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}};
  for (const auto& [normal, first, second] : kAxes) {
    const SkinLayout layout = Layout(3, normal);
    const std::vector<float> values = Values(layout);
    float sums[2] = {};
    for (const int taxel : kTaxels) {
      sums[0] += values[3 * taxel + first];
      sums[1] += values[3 * taxel + second];
    }
    const Shear shear = SumShear(layout, values, rows);
    EXPECT_NEAR(shear.first, sums[0], 1e-6);
    EXPECT_NEAR(shear.second, sums[1], 1e-6);
    if (normal != 2) continue;
    EXPECT_EQ(SumShear(Layout(3, std::nullopt), values, rows), shear);
  }
  EXPECT_EQ(SumShear(Layout(1, 0), Values(Layout(1, 0)), rows), Shear());
}

}  // namespace
}  // namespace tactus::internal
