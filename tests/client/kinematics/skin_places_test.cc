#include "client/kinematics/skin_places.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "client/drivers/icub_skin/skin_patch.h"
#include "core/base/errors.h"
#include "core/features/segmenter.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

SkinLayout Forearm() {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.contact_threshold = layout.onset_threshold = 1;
  return layout;
}

Pose SomePose() {
  return {.position = {0.4, -0.2, 1.1},
          .orientation = Eigen::Quaterniond(
              Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()))};
}

// Where a taxel of a cylinder is, from its angle, written out again.
Eigen::Vector3d OnCylinder(const SkinLayout& layout, double row,
                           double column) {
  const double around = layout.columns * layout.column_pitch_m;
  const double radius = around / (2 * std::numbers::pi);
  const double angle = column * layout.column_pitch_m / radius;
  return {radius * std::cos(angle), radius * std::sin(angle),
          row * layout.row_pitch_m};
}

// Contacts of 3 columns all around the arm, through the segmenter that finds
// the centroid of an answer. The place must lie among the touched taxels, also
// across the seam, where the mean of the columns 23, 0 and 1 would be 8.
TEST(SkinPlacesTest, AContactAcrossTheSeamIsAtTheSeam) {
  const SkinLayout layout = Forearm();
  const SkinPlaces places(layout);
  const Pose pose = SomePose();
  for (int first = 0; first < layout.columns; ++first) {
    std::vector<float> taxels(static_cast<size_t>(layout.taxels()), 0);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      for (int row = 5; row <= 8; ++row) {
        const int column = (first + i) % layout.columns;
        taxels[static_cast<size_t>(row * layout.columns + column)] = 2;
        mean += OnCylinder(layout, row, column) / 12;
      }
    }
    Segmenter segmenter(layout);
    ASSERT_EQ(segmenter.Segment(taxels), 1);
    const Region& region = segmenter.largest();
    const Eigen::Vector3d place =
        places.InWorld({region.centroid_row, region.centroid_column}, pose);
    const Eigen::Vector3d expected =
        pose.position + pose.orientation.toRotationMatrix() * mean;
    // The mean of an arc lies a little inside of the cylinder: 2 (1 - cos) / 3
    // of the radius.
    EXPECT_LT((place - expected).norm(), 0.025 * layout.CylinderRadius())
        << "columns from " << first;
  }
}

TEST(SkinPlacesTest, BetweenTwoTaxelsOfTheSeamIsTheirMiddle) {
  const SkinLayout layout = Forearm();
  const SkinPlaces places(layout);
  const Eigen::Vector3d place = places.OnLink({.row = 0, .column = 23.5});
  EXPECT_LT((place - OnCylinder(layout, 0, -0.5)).norm(), 1e-12);
  EXPECT_NEAR(place.head<2>().norm(), layout.CylinderRadius(), 1e-12);
}

TEST(SkinPlacesTest, AFlatSkinLiesInThePlaneOfItsLink) {
  SkinLayout layout = Forearm();
  layout.wrap_columns = false;
  const SkinPlaces places(layout);
  const Pose pose = SomePose();
  const Eigen::Vector3d expected =
      pose.position + pose.orientation.toRotationMatrix() *
                          Eigen::Vector3d(2.5 * layout.column_pitch_m,
                                          4 * layout.row_pitch_m, 0);
  EXPECT_LT((places.InWorld({.row = 4, .column = 2.5}, pose) - expected).norm(),
            1e-12);
}

// Positions of a cylinder, given taxel by taxel.
std::vector<std::optional<Eigen::Vector3d>> Positions(
    const SkinLayout& layout) {
  std::vector<std::optional<Eigen::Vector3d>> cells;
  for (int i = 0; i < layout.taxels(); ++i) {
    cells.emplace_back(
        OnCylinder(layout, i / layout.columns, i % layout.columns));
  }
  return cells;
}

TEST(SkinPlacesTest, GivenPositionsAreUsedAndInterpolated) {
  const SkinLayout layout = Forearm();
  const auto cells = Positions(layout);
  const auto places = SkinPlaces::FromPositions(layout, cells);
  ASSERT_TRUE(places.ok()) << places.status();
  for (int row = 0; row < layout.rows; ++row) {
    for (int column = 0; column < layout.columns; ++column) {
      const Eigen::Vector3d place =
          places->OnLink({.row = static_cast<double>(row),
                          .column = static_cast<double>(column)});
      EXPECT_LT((place - OnCylinder(layout, row, column)).norm(), 1e-12);
    }
  }
  // In the middle of a chord, also of the one across the seam.
  for (const double column : {7.5, 23.5}) {
    const Eigen::Vector3d place = places->OnLink({.row = 3, .column = column});
    const Eigen::Vector3d chord = (OnCylinder(layout, 3, column - 0.5) +
                                   OnCylinder(layout, 3, column + 0.5)) /
                                  2;
    EXPECT_LT((place - chord).norm(), 1e-12) << column;
  }
}

TEST(SkinPlacesTest, CellsWithoutATaxelDoNotCount) {
  SkinLayout layout = Forearm();
  layout.wrap_columns = false;
  auto cells = Positions(layout);
  const auto at = [&](int row, int column) -> std::optional<Eigen::Vector3d>& {
    return cells[static_cast<size_t>(row * layout.columns + column)];
  };
  at(2, 3).reset();
  at(2, 4).reset();
  at(3, 3).reset();
  const auto places = SkinPlaces::FromPositions(layout, cells);
  ASSERT_TRUE(places.ok()) << places.status();
  // One of the four cells around has a position.
  EXPECT_LT((places->OnLink({.row = 2.2, .column = 3.3}) - *at(3, 4)).norm(),
            1e-12);
  // The cell itself has none: the nearest.
  EXPECT_LT((places->OnLink({.row = 2, .column = 3.4}) - *at(1, 3)).norm(),
            2 * layout.row_pitch_m);
  // Beyond the edge.
  EXPECT_LT(
      (places->OnLink({.row = -1, .column = 99}) - *at(0, layout.columns - 1))
          .norm(),
      1e-12);
}

TEST(SkinPlacesTest, PositionsThatDoNotFitAreRefused) {
  const SkinLayout layout = Forearm();
  const auto error = [&](std::vector<std::optional<Eigen::Vector3d>> cells) {
    const auto places = SkinPlaces::FromPositions(layout, std::move(cells));
    EXPECT_EQ(ReasonOf(places.status()), "INVALID_CONFIG");
    return std::string(places.status().message());
  };
  auto cells = Positions(layout);
  cells.pop_back();
  EXPECT_THAT(error(cells), HasSubstr("384, one per cell"));
  cells.assign(384, std::nullopt);
  EXPECT_THAT(error(cells), HasSubstr("at least one"));
  cells[5] = Eigen::Vector3d(0, std::nan(""), 0);
  EXPECT_THAT(error(cells), HasSubstr("not finite"));
}

// A position file of a half cylinder: each triangle's ten taxels lie along the
// axis, triangle after triangle around it.
TEST(SkinPlacesTest, APositionFilesTaxelsAreWhereItPutsThem) {
  icub::TaxelPositions positions;
  for (int value = 0; value < 192; ++value) {
    const double angle = 0.18 * (value / 12);
    const int dot = value % 12;
    icub::TaxelPosition taxel;
    taxel.present = dot != 6 && dot != 10;
    if (taxel.present) {
      taxel.normal = {std::cos(angle), std::sin(angle), 0};
      taxel.position = 0.05 * taxel.normal + Eigen::Vector3d(0, 0, 0.009 * dot);
    }
    positions.values.push_back(taxel);
  }
  const auto patch = icub::PlacedPatch({{.address = 1}}, positions);
  ASSERT_TRUE(patch.ok()) << patch.status();
  const auto places = SkinPlaces::FromPositions(
      patch->layout, icub::CellPositions(*patch, positions));
  ASSERT_TRUE(places.ok()) << places.status();
  int checked = 0;
  for (size_t value = 0; value < 192; ++value) {
    const int cell = patch->cells[value];
    if (cell < 0) continue;
    ++checked;
    const Eigen::Vector3d place = places->OnLink(
        {.row = static_cast<double>(cell / patch->layout.columns),
         .column = static_cast<double>(cell % patch->layout.columns)});
    EXPECT_LT((place - positions.values[value].position).norm(), 1e-12);
  }
  EXPECT_EQ(checked, 160);
}

}  // namespace
}  // namespace tactus::internal::client
