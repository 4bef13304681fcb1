#include "client/drivers/icub_skin/position_file.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::icub {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PositionFileTest, NameListAndRowsAreRead) {
  const auto positions = ParsePositions(
      "name left_forearm\r\nspatial_sampling taxel\n"
      "taxel2Repr ( 3 3 -2 )\n\n[calibration]\n"
      "0.01 -0.02 0.03 0 0 2\n# a remark\n0 0 0 0 0 0\n"
      "1e-3 0 0 0.0 -1 0 7 8\n[end]\nnot a row\n");
  ASSERT_TRUE(positions.ok()) << positions.status();
  EXPECT_EQ(positions->name, "left_forearm");
  EXPECT_THAT(positions->representatives, ElementsAre(3, 3, -2));
  ASSERT_EQ(positions->values.size(), 3u);
  EXPECT_TRUE(positions->values[0].present);
  EXPECT_EQ(positions->values[0].position, Eigen::Vector3d(0.01, -0.02, 0.03));
  EXPECT_EQ(positions->values[0].normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_FALSE(positions->values[1].present);
  EXPECT_EQ(positions->values[2].normal, Eigen::Vector3d(0, -1, 0));
}

TEST(PositionFileTest, MistakesNameTheLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"[calibration]\n0 0 1 0 0\n", "line 2"},
      {"name x\n[calibration]\n1 2 3 0 0 1\n0 0 nan 0 0 1\n", "line 4"},
      {"[calibration]\n\n0 0 11 0 0 1\n", "line 3"},
      {"[calibration]\n0 0 inf 0 0 1\n", "line 2"},
      {"taxel2Repr ( 1 two )\n", "line 1"},
      {"taxel2Repr ( -3 )\n", "line 1"},
      {"[calibration]\n0 0 0 0 0 0\n", "no taxel"},
      {"", "no taxel"},
  };
  for (const auto& [text, where] : cases) {
    const absl::Status status = ParsePositions(text).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(where));
  }
}

TEST(PositionFileTest, RowsAreLimited) {
  std::string text = "[calibration]\n";
  for (int i = 0; i < 14 * 192; ++i) text += "0.1 0 0 0 0 1\n";
  EXPECT_TRUE(ParsePositions(text).ok());
  EXPECT_EQ(ReasonOf(ParsePositions(text + "0.1 0 0 0 0 1\n").status()),
            "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal::client::icub
