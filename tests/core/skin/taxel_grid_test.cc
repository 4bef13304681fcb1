#include "core/skin/taxel_grid.h"

#include <cmath>
#include <set>

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

std::vector<Eigen::Vector3d> Square(int rows, int columns, double pitch) {
  std::vector<Eigen::Vector3d> positions;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      positions.emplace_back(0.3 + c * pitch, -0.1 + r * pitch, 0);
    }
  }
  return positions;
}

TEST(TaxelGridTest, ASquareSkinIsItself) {
  const auto grid = PlaceOnGrid(Square(7, 31, 0.0042));
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->rows, 7);
  EXPECT_EQ(grid->columns, 31);
  EXPECT_NEAR(grid->row_pitch_m, 0.0042, 1e-12);
  EXPECT_NEAR(grid->column_pitch_m, 0.0042, 1e-12);
  EXPECT_TRUE(grid->mask.empty());
  for (int i = 0; i < 7 * 31; ++i) EXPECT_EQ(grid->cells[i], i);
  // 7 * 30 along rows and 6 * 31 along columns; diagonals are 1.41 apart.
  EXPECT_EQ(grid->neighbours, 7 * 30 + 6 * 31);
  EXPECT_EQ(grid->separated, 0);
}

// Six neighbours at one distance; rows are shifted by half a pitch in turn.
TEST(TaxelGridTest, ATriangularSkinKeepsItsNeighbours) {
  std::vector<Eigen::Vector3d> positions;
  for (int r = 0; r < 30; ++r) {
    for (int c = 0; c < 12; ++c) {
      positions.emplace_back(0.01 * (c + 0.5 * (r % 2)),
                             0.01 * r * std::sqrt(0.75), 0);
    }
  }
  const auto grid = PlaceOnGrid(positions);
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->rows, 30);
  EXPECT_NEAR(grid->row_pitch_m, 0.01 * std::sqrt(0.75), 1e-12);
  EXPECT_EQ(grid->separated, 0);
  const std::set<int> cells(grid->cells.begin(), grid->cells.end());
  EXPECT_EQ(cells.size(), positions.size());
  for (const int cell : cells) {
    EXPECT_TRUE(grid->mask.empty() || grid->mask[cell] == 1);
  }
}

TEST(TaxelGridTest, ATiltedSkinLiesAlongItsAxes) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())
          .toRotationMatrix();
  auto positions = Square(4, 20, 0.005);
  for (auto& position : positions) position = turn * position;
  const auto grid = PlaceOnGrid(positions);
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->rows, 4);
  EXPECT_EQ(grid->columns, 20);
  EXPECT_EQ(grid->separated, 0);
}

TEST(TaxelGridTest, HolesAreMasked) {
  auto positions = Square(5, 5, 0.01);
  positions.erase(positions.begin() + 12);
  const auto grid = PlaceOnGrid(positions);
  ASSERT_TRUE(grid.ok()) << grid.status();
  ASSERT_EQ(grid->mask.size(), 25u);
  for (int i = 0; i < 25; ++i) EXPECT_EQ(grid->mask[i], i != 12) << i;
  EXPECT_EQ(grid->cells[12], 13);
}

TEST(TaxelGridTest, WhatIsNoSkinIsRefused) {
  EXPECT_EQ(ReasonOf(PlaceOnGrid({{0, 0, 0}}).status()), "INVALID_CONFIG");
  auto twice = Square(2, 2, 0.01);
  twice.push_back(twice.front());
  EXPECT_EQ(ReasonOf(PlaceOnGrid(twice).status()), "INVALID_CONFIG");
  // Two patches a metre apart, of taxels a millimetre apart.
  auto apart = Square(2, 2, 0.001);
  apart.emplace_back(1, 1, 0);
  EXPECT_EQ(ReasonOf(PlaceOnGrid(apart).status()), "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
