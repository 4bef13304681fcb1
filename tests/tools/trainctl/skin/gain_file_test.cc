#include "tools/trainctl/skin/gain_file.h"

#include <filesystem>
#include <fstream>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<std::vector<std::optional<GainCurve>>> GainsOf(
    const std::string& lines) {
  const std::string path =
      std::filesystem::path(::testing::TempDir()) / "gains.csv";
  std::ofstream(path) << "taxel,reading,load\n" << lines;
  return ReadGains(path, 4);
}

TEST(GainFileTest, ATaxelsCurveReplacesThatOfAll) {
  const auto gains = GainsOf("2,10,1\n*,10,3\n2,20,5\n*,30,6\n");
  ASSERT_TRUE(gains.ok()) << gains.status();
  ASSERT_EQ(gains->size(), 4u);
  EXPECT_EQ((*gains)[0]->Load(30), 6);
  EXPECT_EQ((*gains)[2]->Load(20), 5);
  const auto one = GainsOf("2,10,1\n");
  ASSERT_TRUE(one.ok());
  EXPECT_FALSE((*one)[0]);
  EXPECT_TRUE((*one)[2]);
}

TEST(GainFileTest, FaultsAreNamed) {
  EXPECT_THAT(GainsOf("4,10,1\n").status().message(),
              HasSubstr("taxel is 4; it must be * or 0 to 3"));
  EXPECT_FALSE(GainsOf("-1,10,1\n").ok());
  EXPECT_FALSE(GainsOf("1,ten,1\n").ok());
  const auto falling = GainsOf("1,10,1\n1,20,0.5\n");
  EXPECT_EQ(ReasonOf(falling.status()), "INVALID_CONFIG");
  EXPECT_THAT(falling.status().message(), HasSubstr("taxel 1: gain curve"));
}

}  // namespace
}  // namespace tactus::internal::client
