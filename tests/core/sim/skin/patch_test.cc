#include "core/sim/skin/patch.h"

#include <cmath>
#include <numeric>

#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus {
namespace {

using testing::FlatLayout;

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// The dome summed on a fine grid of points instead of integrated.
TEST(SpreadPatchTest, MatchesBruteForceOnAFineGrid) {
  const SkinLayout layout = FlatLayout(6, 9);
  const SkinPoint centre = {1.3, 7.1};
  const double side = 0.0437;
  PatchShares shares;
  SpreadPatch(layout, centre, side, shares);
  std::vector<double> expected(layout.taxels(), 0);
  double total = 0;
  constexpr int kGrid = 1000;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double u = (2 * i + 1.0) / kGrid - 1;
      const double v = (2 * j + 1.0) / kGrid - 1;
      const long row = std::lround(centre.row + u * side / 2 / 0.01);
      const long column = std::lround(centre.column + v * side / 2 / 0.01);
      if (row < 0 || row >= 6 || column < 0 || column >= 9) continue;
      const double pressure = (1 - u * u / 2) * (1 - v * v / 2);
      expected[row * 9 + column] += pressure;
      total += pressure;
    }
  }
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 9; ++column) {
      EXPECT_NEAR(shares.Of(row, column), expected[row * 9 + column] / total,
                  1e-3)
          << row << ", " << column;
    }
  }
}

TEST(SpreadPatchTest, ASmallPatchIsCarriedByTheTaxelUnderIt) {
  PatchShares shares;
  SpreadPatch(FlatLayout(6, 9), {2, 3}, 0.01, shares);
  EXPECT_NEAR(shares.Of(2, 3), 1, 1e-12);
  SpreadPatch(FlatLayout(6, 9), {2.5, 3}, 0.001, shares);
  EXPECT_NEAR(shares.Of(2, 3), 0.5, 1e-12);
  EXPECT_NEAR(shares.Of(3, 3), 0.5, 1e-12);
}

TEST(SpreadPatchTest, APatchBeyondTheSkinIsCarriedByAllOfIt) {
  PatchShares shares;
  SpreadPatch(FlatLayout(3, 4), {0, 3}, 0.5, shares);
  EXPECT_NEAR(Sum(shares.rows), 1, 1e-12);
  EXPECT_NEAR(Sum(shares.columns), 1, 1e-12);
  for (double share : shares.rows) EXPECT_NEAR(share, 1.0 / 3, 0.01);
}

TEST(SpreadPatchTest, WrapsRoundTheCylinder) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  PatchShares shares;
  SpreadPatch(layout, {8, 23.5}, 0.03, shares);
  EXPECT_NEAR(shares.columns[23], shares.columns[0], 1e-12);
  EXPECT_NEAR(shares.columns[22], shares.columns[1], 1e-12);
  EXPECT_GT(shares.columns[0], 0.3);
  EXPECT_NEAR(Sum(shares.columns), 1, 1e-12);
}

TEST(SpreadPatchTest, AFlatFaceTouchesAtMostHalfTheCircumference) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  PatchShares shares;
  SpreadPatch(layout, {8, 4}, 0.2, shares);
  int touched = 0;
  for (double share : shares.columns) touched += share > 0;
  // Columns 4 - 6 and 4 + 6 (= 22) are touched by half.
  EXPECT_EQ(touched, 13);
  EXPECT_NEAR(shares.columns[22], shares.columns[10], 1e-12);
  EXPECT_EQ(shares.columns[16], 0);
  EXPECT_NEAR(Sum(shares.columns), 1, 1e-12);
}

}  // namespace
}  // namespace tactus
