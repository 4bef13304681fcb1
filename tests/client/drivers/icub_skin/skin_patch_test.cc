#include "client/drivers/icub_skin/skin_patch.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::icub {
namespace {

TEST(SkinPatchTest, TheForearmsHave23And24Triangles) {
  const auto triangles = [](const std::vector<SkinBoard>& boards) {
    int count = 0;
    for (const SkinBoard& b : boards) count += std::popcount(b.triangles);
    return count;
  };
  const auto v1 = ParseBoards("forearm-v1");
  const auto v2 = ParseBoards("forearm-v2");
  ASSERT_TRUE(v1.ok() && v2.ok());
  EXPECT_EQ(triangles(*v1), 23);
  EXPECT_EQ(triangles(*v2), 24);
  // Board 13 is first on the port.
  EXPECT_EQ((*v2)[0], (SkinBoard{.address = 13, .triangles = 0xFFFF}));
  // 16, 17, 19, 22, 24, 25, 28 and 29 of the arm.
  EXPECT_EQ((*v2)[1],
            (SkinBoard{.address = 12,
                       .triangles = 1 << 0 | 1 << 1 | 1 << 3 | 1 << 6 | 1 << 8 |
                                    1 << 9 | 1 << 12 | 1 << 13}));
}

TEST(SkinPatchTest, ListsOfBoardsAreChecked) {
  const auto boards = ParseBoards("3:0+2-4,14");
  ASSERT_TRUE(boards.ok());
  EXPECT_EQ((*boards)[0], (SkinBoard{.address = 3, .triangles = 0b11101}));
  EXPECT_EQ((*boards)[1], (SkinBoard{.address = 14, .triangles = 0xFFFF}));
  for (const char* bad : {"", "0", "15", "3,3", "3:", "3:16", "3:4-2", "3:1-",
                          "x", "3:a", "3,", "3:1+", "-3", "forearm-v3"}) {
    EXPECT_EQ(ReasonOf(ParseBoards(bad).status()), "INVALID_CONFIG") << bad;
  }
}

TEST(SkinPatchTest, APortHas384ValuesAnd240Taxels) {
  const auto patch = PortPatch(*ParseBoards("forearm-v2"));
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_EQ(patch->cells.size(), 384u);
  EXPECT_EQ(patch->layout.rows, 32);
  EXPECT_EQ(patch->layout.columns, 12);
  EXPECT_EQ(std::count(patch->layout.mask.begin(), patch->layout.mask.end(), 1),
            240);
  EXPECT_EQ(patch->cells[5], 5);
  // Thermal pads.
  EXPECT_EQ(patch->cells[6], -1);
  EXPECT_EQ(patch->cells[10], -1);
  // Triangle 2 of board 12 is not there.
  EXPECT_EQ(patch->cells[192 + 24], -1);
  EXPECT_FALSE(PortPatch({}).ok());
  EXPECT_FALSE(PortPatch(*ParseBoards("1,2,3,4,5,6")).ok());
}

// A flat board of 4 x 4 triangles, dots on a square grid but for the pads.
TaxelPositions FlatPositions() {
  TaxelPositions positions;
  positions.name = "flat";
  for (int i = 0; i < kBoardValues; ++i) {
    TaxelPosition taxel;
    const int dot = i % kDots;
    taxel.present = dot != 6 && dot != 10;
    const int column = i / kDots % 4 * 4 + dot % 4;
    const int row = i / kDots / 4 * 3 + dot / 4;
    if (taxel.present) taxel.position = {0.005 * column, 0.006 * row, 0.2};
    positions.values.push_back(taxel);
  }
  return positions;
}

TEST(SkinPatchTest, TaxelsOfKnownPositionsLieOnAGrid) {
  const TaxelPositions positions = FlatPositions();
  const auto patch =
      PlacedPatch({{.address = 2, .triangles = 0x7FFF}}, positions);
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_EQ(patch->layout.name, "flat");
  const auto at = [&](int value) {
    const int cell = patch->cells[value];
    return std::pair(cell / patch->layout.columns,
                     cell % patch->layout.columns);
  };
  // Dots 0 and 1 of triangle 5 are neighbours in a row, 0 and 4 in a column.
  const auto [row, column] = at(5 * kDots);
  EXPECT_EQ(at(5 * kDots + 1), std::pair(row, column + 1));
  EXPECT_EQ(at(5 * kDots + 4), std::pair(row + 1, column));
  EXPECT_EQ(patch->cells[6], -1);
  // The last triangle has a position but is not there.
  for (int k = 0; k < kDots; ++k) EXPECT_EQ(patch->cells[15 * kDots + k], -1);
  EXPECT_EQ(
      ReasonOf(
          PlacedPatch({{.address = 2}, {.address = 3}}, positions).status()),
      "INVALID_CONFIG");
}

// A board around a cylinder of radius 40 mm, 7 mm between taxels: 16 triangles
// in a ring of 270 degrees, each 3 columns of 4 rows.
TEST(SkinPatchTest, ACurvedPatchIsLaidFlat) {
  TaxelPositions positions;
  const auto at = [](int column, int row) {
    const double angle = 2.1 + column * 0.0982;
    TaxelPosition taxel;
    taxel.present = true;
    taxel.normal = {std::cos(angle), 0, std::sin(angle)};
    taxel.position = 0.04 * taxel.normal;
    taxel.position += Eigen::Vector3d(0.01, 0.0039 * row, -0.02);
    return taxel;
  };
  for (int i = 0; i < kBoardValues; ++i) {
    positions.values.push_back(at(i / kDots * 3 + i % 3, i % kDots / 3));
  }
  const auto patch = PlacedPatch({{.address = 2}}, positions, 0);
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_TRUE(patch->layout.mask.empty());
  EXPECT_EQ(patch->layout.taxels(), 192);
  EXPECT_EQ(std::max(patch->layout.rows, patch->layout.columns), 48);
  // The pitch around the cylinder.
  const double pitches[] = {patch->layout.row_pitch_m,
                            patch->layout.column_pitch_m};
  EXPECT_NEAR(*std::max_element(pitches, pitches + 2), 0.0039, 0.0002);
  // Seen from one side, both halves would lie on each other.
  std::vector<int> cells = patch->cells;
  std::sort(cells.begin(), cells.end());
  for (int i = 0; i < kBoardValues; ++i) EXPECT_EQ(cells[i], i);
}

TEST(SkinPatchTest, TaxelsOfOnePlaceShareACellAndPadsAreNone) {
  TaxelPositions positions = FlatPositions();
  // Dots 3, 4 and 5 of triangle 0 have the place of dot 3; the file names a
  // place for a pad, and calls dot 0 of triangle 1 no taxel.
  positions.values[4].position = positions.values[3].position;
  positions.values[5].position = positions.values[3].position;
  positions.values[6] = {.present = true, .position = {0.09, 0.09, 0.2}};
  positions.representatives.assign(kBoardValues, 3);
  positions.representatives[12] = -2;
  const auto patch = PlacedPatch({{.address = 2}}, positions);
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_GE(patch->cells[3], 0);
  EXPECT_EQ(patch->cells[4], patch->cells[3]);
  EXPECT_EQ(patch->cells[5], patch->cells[3]);
  EXPECT_NE(patch->cells[2], patch->cells[3]);
  EXPECT_EQ(patch->cells[6], -1);
  EXPECT_EQ(patch->cells[12], -1);
  EXPECT_GE(patch->cells[13], 0);
}

// A patch with two taxels that are a hundred times closer than all others.
TEST(SkinPatchTest, PlacesThatFitOnNoGridAreRounded) {
  TaxelPositions positions = FlatPositions();
  positions.values[1].position =
      positions.values[0].position + Eigen::Vector3d(0.00005, 0, 0);
  const auto patch = PlacedPatch({{.address = 2}}, positions);
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_EQ(patch->cells[0], patch->cells[1]);
  EXPECT_NEAR(patch->layout.row_pitch_m, 0.005, 1e-9);
  EXPECT_NEAR(patch->layout.taxels(), 16 * 13, 16);
  TaxelPositions one;
  one.values.resize(kBoardValues);
  one.values[0].present = true;
  EXPECT_EQ(ReasonOf(PlacedPatch({{.address = 2}}, one).status()),
            "INVALID_CONFIG");
}

TEST(SkinPatchTest, ItHasOneAxis) {
  SkinPatch patch = *PortPatch({{.address = 1}});
  patch.layout.axes = 3;
  const absl::Status status = Validate(patch);
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_NE(status.message().find("axes of the layout of an iCub's skin"),
            std::string::npos)
      << status;
}

TEST(SkinPatchTest, CellsMustFitTheLayout) {
  SkinPatch patch = *PortPatch({{.address = 1}});
  EXPECT_TRUE(Validate(patch).ok());
  SkinPatch below = patch;
  below.cells[0] = -2;
  EXPECT_EQ(ReasonOf(Validate(below)), "INVALID_CONFIG");
  SkinPatch outside = patch;
  outside.cells[0] = 192;
  EXPECT_EQ(ReasonOf(Validate(outside)), "INVALID_CONFIG");
  SkinPatch few = patch;
  few.cells.pop_back();
  EXPECT_EQ(ReasonOf(Validate(few)), "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal::client::icub
