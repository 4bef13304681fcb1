// The matrix of a taxel of three axes, fitted to known loads.
#include "client/drivers/calibration/cross_axis.h"

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/three_axis_skin.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using testing::ThreeAxisSkin;

double LargestError(const CrossAxis& matrix, const CrossAxis& truth) {
  double error = 0;
  double largest = 0;
  for (size_t i = 0; i < kMostAxes; ++i) {
    for (size_t j = 0; j < kMostAxes; ++j) {
      error = std::max(error, std::abs(matrix.rows[i][j] - truth.rows[i][j]));
      largest = std::max(largest, std::abs(truth.rows[i][j]));
    }
  }
  return error / largest;
}

TEST(CrossAxisTest, ExactLoadsGiveTheExactMatrix) {
  const ThreeAxisSkin skin({});
  for (const size_t taxel : {0U, 9U, 31U}) {
    for (const int lines : {3, 40}) {
      const auto fit = FitCrossAxis(skin.KnownLoads(taxel, lines, 0, 5));
      ASSERT_TRUE(fit.ok()) << fit.status();
      EXPECT_LT(LargestError(fit->cross_axis, skin.Truth(taxel)), 1e-9);
      for (const double squares : fit->squares) EXPECT_LT(squares, 1e-18);
    }
  }
}

// Noise of 2 counts, with readings of about 170 counts along x and y: 40 lines
// leave 0.2 % of an element as a standard error.
TEST(CrossAxisTest, NoisyLoadsGiveTheMatrixWithinOnePercent) {
  const ThreeAxisSkin skin({});
  for (size_t taxel = 0; taxel < 32; ++taxel) {
    const auto known = skin.KnownLoads(taxel, 40, 2, taxel + 1);
    const auto fit = FitCrossAxis(known);
    ASSERT_TRUE(fit.ok()) << fit.status();
    const CrossAxis truth = skin.Truth(taxel);
    EXPECT_LT(LargestError(fit->cross_axis, truth), 0.01) << taxel;
    // The errors are those of the noise, 2 counts through each row.
    for (size_t axis = 0; axis < kMostAxes; ++axis) {
      double noise = 0;
      for (const double element : truth.rows[axis]) {
        noise += std::pow(2 * element, 2);
      }
      EXPECT_NEAR(std::sqrt(fit->squares[axis] / 40) / std::sqrt(noise), 1,
                  0.5);
    }
  }
}

TEST(CrossAxisTest, ReadingsThatSpanFewerDirectionsAreRefused) {
  const ThreeAxisSkin skin({});
  std::vector<KnownLoad> known = skin.KnownLoads(4, 30, 0, 3);
  EXPECT_THAT(FitCrossAxis({}).status().message(),
              HasSubstr("directions of the readings of known loads is 0 in 0 "
                        "lines; it must be 3: press, and pull"));
  EXPECT_THAT(FitCrossAxis(std::span(known).first(2)).status().message(),
              HasSubstr("is 2 in 2 lines"));
  // Never pulled along x, but for what is a 10,000th of a press.
  for (KnownLoad& line : known) line.reading[0] = 1e-4 * line.reading[2];
  const absl::Status flat = FitCrossAxis(known).status();
  EXPECT_EQ(ReasonOf(flat), "INVALID_CONFIG");
  EXPECT_THAT(flat.message(), HasSubstr("is 2 in 30 lines"));
  // One press, thirty times.
  for (KnownLoad& line : known) line = known[0];
  EXPECT_THAT(FitCrossAxis(known).status().message(), HasSubstr("is 1 in 30"));
  for (KnownLoad& line : known) line.reading = {};
  EXPECT_THAT(FitCrossAxis(known).status().message(), HasSubstr("is 0 in 30"));
}

TEST(CrossAxisTest, NumbersThatAreNotFiniteAreRefused) {
  const ThreeAxisSkin skin({});
  for (const double bad :
       {std::nan(""), 1e13, -1e300, std::numeric_limits<double>::infinity()}) {
    std::vector<KnownLoad> known = skin.KnownLoads(4, 30, 0, 3);
    known[7].reading[1] = bad;
    const absl::Status reading = FitCrossAxis(known).status();
    EXPECT_EQ(ReasonOf(reading), "INVALID_CONFIG");
    EXPECT_THAT(reading.message(), HasSubstr("reading_y is "));
    EXPECT_THAT(reading.message(), HasSubstr("finite, from -1e+12 to 1e+12"));
    known = skin.KnownLoads(4, 30, 0, 3);
    known[7].load[2] = bad;
    EXPECT_THAT(FitCrossAxis(known).status().message(),
                HasSubstr("load_z is "));
  }
}

TEST(CrossAxisTest, MatricesAreOneForAllOrOnePerTaxel) {
  const ThreeAxisSkin skin({});
  const CrossAxes all = skin.Truths();
  EXPECT_EQ(MatrixOf({}, 3), nullptr);
  EXPECT_EQ(*MatrixOf(all, 3), skin.Truth(3));
  EXPECT_EQ(*MatrixOf({skin.Truth(1)}, 3), skin.Truth(1));
  EXPECT_TRUE(CheckMatrices({}, 32).ok());
  EXPECT_TRUE(CheckMatrices(all, 32).ok());
  EXPECT_TRUE(CheckMatrices({skin.Truth(1)}, 32).ok());
  EXPECT_THAT(
      CheckMatrices(all, 16).message(),
      HasSubstr("matrices of cross_axis is 32; it must be none, 1 or 16"));
  CrossAxes bad = all;
  bad[6]->rows[1][2] = std::nan("");
  EXPECT_THAT(CheckMatrices(bad, 32).message(),
              HasSubstr("cross_axis of taxel 6, load_y per reading_z is nan"));
}

}  // namespace
}  // namespace tactus::internal::client
