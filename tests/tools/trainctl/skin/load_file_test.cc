#include "tools/trainctl/skin/load_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

constexpr char kHeader[] =
    "taxel,reading_x,reading_y,reading_z,load_x,load_y,load_z\n";
// Loads are 1, 2 and 3 times the readings.
constexpr char kTriple[] =
    "*,10,0,0,10,0,0\n*,0,10,0,0,20,0\n*,0,0,10,0,0,30\n";

absl::StatusOr<LoadFile> LoadsOf(const std::string& lines,
                                 const std::string& header = kHeader) {
  const std::string path =
      std::filesystem::path(::testing::TempDir()) / "loads.csv";
  std::ofstream(path) << header << lines;
  return ReadLoads(path, 4);
}

std::string MessageOf(const std::string& lines,
                      const std::string& header = kHeader) {
  return std::string(LoadsOf(lines, header).status().message());
}

TEST(LoadFileTest, OneMatrixForAll) {
  const auto file = LoadsOf(kTriple);
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->cross_axis.size(), 1U);
  EXPECT_EQ(file->lines, 3U);
  const AxisVector load = MatrixOf(file->cross_axis, 3)->Load({1, 1, 1});
  for (size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(load[axis], static_cast<double>(axis + 1), 1e-12);
    EXPECT_NEAR(file->residual[axis], 0, 1e-12);
  }
}

TEST(LoadFileTest, ATaxelsMatrixReplacesThatOfAll) {
  const std::string taxel = "2,10,0,0,5,0,0\n2,0,10,0,0,5,0\n2,0,0,10,0,0,5\n";
  auto file = LoadsOf(taxel + kTriple);
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->cross_axis.size(), 4U);
  EXPECT_NEAR(MatrixOf(file->cross_axis, 2)->Load({1, 1, 1})[2], 0.5, 1e-12);
  EXPECT_NEAR(MatrixOf(file->cross_axis, 3)->Load({1, 1, 1})[2], 3, 1e-12);
  file = LoadsOf(taxel);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_NE(MatrixOf(file->cross_axis, 2), nullptr);
  EXPECT_EQ(MatrixOf(file->cross_axis, 3), nullptr);
}

// Two lines of one press whose loads differ by 2 leave 1 each.
TEST(LoadFileTest, TheResidualIsTheRootOfTheMeanSquare) {
  const auto file = LoadsOf(
      "*,10,0,0,10,0,0\n*,0,10,0,0,10,0\n*,0,0,10,0,0,9\n*,0,0,10,0,0,11\n");
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_NEAR(file->residual[0], 0, 1e-12);
  EXPECT_NEAR(file->residual[2], std::sqrt(2.0 / 4), 1e-12);
}

TEST(LoadFileTest, EachFaultIsNamed) {
  const std::string two = "1,10,0,0,10,0,0\n1,0,10,0,0,20,0\n";
  const absl::Status flat = LoadsOf(two + "1,5,5,0,5,10,0\n").status();
  EXPECT_EQ(ReasonOf(flat), "INVALID_CONFIG");
  EXPECT_THAT(std::string(flat.message()),
              HasSubstr("loads.csv: taxel 1: directions of the readings of "
                        "known loads is 2 in 3 lines; it must be 3: press"));
  EXPECT_THAT(MessageOf("*,1,2,3,1,2,3\n"),
              HasSubstr("taxel *: directions of the readings of known loads is "
                        "1 in 1 lines"));
  EXPECT_THAT(MessageOf(two + "1,0,0,1e13,0,0,1\n"),
              HasSubstr("taxel 1: reading_z is 1e+13; it must be finite"));
  EXPECT_THAT(MessageOf(two + "1,0,0,nan,0,0,1\n"),
              HasSubstr("line 4: reading_z is \"nan\"; it must be a finite"));
  EXPECT_THAT(MessageOf(two + "1,0,0,1,0,0,inf\n"),
              HasSubstr("line 4: load_z is \"inf\"; it must be a finite"));
  EXPECT_THAT(MessageOf("4,1,2,3,1,2,3\n"),
              HasSubstr("taxel is 4; it must be * or 0 to 3"));
  EXPECT_THAT(MessageOf(""), HasSubstr("lines of known loads is 0"));
  // Such as a file for --gains.
  EXPECT_THAT(MessageOf("*,40,1\n", "taxel,reading,load\n"),
              HasSubstr("reading_x"));
}

TEST(LoadFileTest, CurvesAreForOneAxisAndKnownLoadsForThree) {
  SkinLayout layout;
  EXPECT_TRUE(CheckLoadFlags("g.csv", "", layout).ok());
  const absl::Status loads = CheckLoadFlags("", "l.csv", layout);
  EXPECT_EQ(ReasonOf(loads), "INVALID_CONFIG");
  EXPECT_THAT(std::string(loads.message()),
              HasSubstr("--loads is given for a skin of one axis; it must be "
                        "--gains"));
  layout.axes = 3;
  EXPECT_TRUE(CheckLoadFlags("", "l.csv", layout).ok());
  const absl::Status gains = CheckLoadFlags("g.csv", "", layout);
  EXPECT_EQ(ReasonOf(gains), "INVALID_CONFIG");
  EXPECT_THAT(std::string(gains.message()),
              HasSubstr("--gains is given for a skin of three axes; it must be "
                        "--loads"));
}

}  // namespace
}  // namespace tactus::internal::client
