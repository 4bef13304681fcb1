#include "core/sim/skin/line_contact.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

SkinLayout ForearmLayout() { return *LayoutPreset("cody-forearm"); }

// The same bed of springs on a fine grid, with the indentation by bisection.
std::vector<double> PressedOnGrid(const SkinLayout& layout,
                                  const SkinPoint& centre, double force,
                                  const PressedFace& face) {
  constexpr int kPoints = 24;  // along each side of a taxel
  const double radius = layout.CylinderRadius();
  const auto press = [&](double d, std::vector<double>& taxels) {
    std::ranges::fill(taxels, 0);
    const double dy = layout.row_pitch_m / kPoints;
    const double ds = layout.column_pitch_m / kPoints;
    for (int i = 0; i < layout.rows * kPoints; ++i) {
      const double y =
          ((i + 0.5) / kPoints - 0.5 - centre.row) * layout.row_pitch_m;
      if (std::abs(y) > face.edge_m / 2) continue;
      for (int j = 0; j < layout.columns * kPoints; ++j) {
        double s =
            ((j + 0.5) / kPoints - 0.5 - centre.column) * layout.column_pitch_m;
        const double round = layout.columns * layout.column_pitch_m;
        if (layout.wrap_columns) s -= round * std::round(s / round);
        if (std::abs(s) > face.edge_m / 2) continue;
        double depth = d + y * std::tan(face.tilt_rad);
        if (layout.wrap_columns) {
          if (std::abs(s) > round / 4) continue;
          depth -= s * s / (2 * radius);
        }
        if (depth <= 0) continue;
        taxels[i / kPoints * layout.columns + j / kPoints] +=
            face.bedding_n_m3 * depth * dy * ds;
      }
    }
    return std::accumulate(taxels.begin(), taxels.end(), 0.0);
  };
  std::vector<double> taxels(layout.taxels());
  double low = -1;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (press(middle, taxels) < force ? low : high) = middle;
  }
  press(high, taxels);
  return taxels;
}

double LargestDifference(const std::vector<double>& a,
                         const std::vector<double>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

TEST(LineContactTest, EqualsABedOfSpringsOnAFineGrid) {
  Random random(5);
  SkinLayout flat = ForearmLayout();
  flat.wrap_columns = false;
  for (int n = 0; n < 24; ++n) {
    const SkinLayout layout = n % 3 == 2 ? flat : ForearmLayout();
    const SkinPoint centre = {random.Uniform(0, layout.rows - 1),
                              random.Uniform(0, layout.columns - 1)};
    const PressedFace face = {
        .edge_m = random.Uniform(0.01, 0.1),
        .bedding_n_m3 = std::pow(10, random.Uniform(4, 7.5)),
        .tilt_rad = n % 2 == 0 ? 0 : random.Uniform(-0.02, 0.02)};
    const double force = std::pow(10, random.Uniform(-2, 1));
    LineContact contact(layout, centre);
    contact.Press(force, face);
    const auto expected = PressedOnGrid(layout, centre, force, face);
    EXPECT_LT(LargestDifference(contact.taxels(), expected), 0.03 * force)
        << "contact " << n;
  }
}

TEST(LineContactTest, TheTaxelsCarryTheWholeForce) {
  LineContact contact(ForearmLayout(), {.row = 0.2, .column = 23.7});
  for (const double force : {1e-6, 0.01, 3.0, 40.0}) {
    contact.Press(force, {.edge_m = 0.06, .bedding_n_m3 = 1e6, .tilt_rad = 1});
    EXPECT_NEAR(
        std::accumulate(contact.taxels().begin(), contact.taxels().end(), 0.0),
        force, 1e-12 * force);
  }
  contact.Press(0, {.edge_m = 0.06, .bedding_n_m3 = 1e6});
  EXPECT_THAT(contact.taxels(), testing::Each(0));
}

// One that presses on and off, and the same again, equals new ones.
TEST(LineContactTest, NothingIsLeftOfTheLastPress) {
  Random random(9);
  const SkinPoint centre = {.row = 3.2, .column = 23.4};
  LineContact one(ForearmLayout(), centre);
  const PressedFace soft = {
      .edge_m = 0.09, .bedding_n_m3 = 1e5, .tilt_rad = 0.01};
  const PressedFace hard = {.edge_m = 0.02, .bedding_n_m3 = 2e7};
  for (int i = 0; i < 100; ++i) {
    const double force = random.Index(4) == 0 ? 0 : 1.0 + random.Index(2);
    const PressedFace& face = random.Index(2) == 0 ? soft : hard;
    one.Press(force, face);
    LineContact fresh(ForearmLayout(), centre);
    fresh.Press(force, face);
    ASSERT_EQ(one.taxels(), fresh.taxels());
    if (force > 0) {
      ASSERT_EQ(one.indentation_m(), fresh.indentation_m());
    }
  }
}

// As long as the line is narrower than the face.
TEST(LineContactTest, AnUnclippedIndentationHasItsClosedForm) {
  const SkinLayout layout = ForearmLayout();
  LineContact contact(layout, {.row = 7, .column = 5});
  const double edge = 3 * layout.row_pitch_m;
  contact.Press(2, {.edge_m = edge, .bedding_n_m3 = 2e7});
  // Force for each metre of length: (4/3) bedding sqrt(2 R) d^(3/2).
  const double radius = layout.CylinderRadius();
  const double d =
      std::pow(2 / edge * 0.75 / (2e7 * std::sqrt(2 * radius)), 2.0 / 3.0);
  EXPECT_NEAR(contact.indentation_m(), d, 1e-12);
}

TEST(LineContactTest, AHardObjectTouchesALineAndASoftOneWraps) {
  LineContact contact(ForearmLayout(), {.row = 7, .column = 5});
  const auto columns = [&](double youngs_modulus) {
    contact.Press(
        3, {.edge_m = 0.1, .bedding_n_m3 = Bedding(youngs_modulus, 0.1, 2e7)});
    int count = 0;
    for (int column = 0; column < 24; ++column) {
      count += contact.taxels()[7 * 24 + column] > 0;
    }
    return count;
  };
  EXPECT_LE(columns(7e10), 3);
  EXPECT_GE(columns(2e3), 7);
}

// The real frame of this forearm (docs/simulator.md): 9 N on four rows and two
// columns, 0.56 to 1.53 N each.
TEST(LineContactTest, ARealContactIsASampleOfIt) {
  LineContact contact(ForearmLayout(), {.row = 7.5, .column = 9.45});
  contact.Press(9, {.edge_m = 0.043,
                    .bedding_n_m3 = Bedding(1e9, 0.043, 2e7),
                    .tilt_rad = -0.003});
  int touched = 0;
  for (int row = 6; row <= 9; ++row) {
    for (int column = 9; column <= 10; ++column) {
      const double taxel = contact.taxels()[row * 24 + column];
      touched += taxel > 0.5 && taxel < 1.7;
    }
  }
  EXPECT_EQ(touched, 8);
}

}  // namespace
}  // namespace tactus::internal
