// `trainctl reproduce` asked for Cody's frames without a skin, was refused, and
// printed 21 empty rows with exit code 0.
#include "gtest/gtest.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

TEST(ReproductionWithoutContactsTest, CodysRowsHaveResults) {
  const auto run = testing::RunTrainctl(
      "reproduce --experiment=cody --only=1nn --seed=1 --json");
  ASSERT_TRUE(run.status.ok()) << run.status;
  const client::Json rows = client::Json::parse(run.out)["rows"];
  EXPECT_EQ(rows.size(), 7u);
  for (const client::Json& row : rows) {
    EXPECT_EQ(row["trials"], 240);
    // A quarter is chance.
    EXPECT_GT(row["ours"], 25) << row;
  }
}

}  // namespace
}  // namespace tactus::internal
