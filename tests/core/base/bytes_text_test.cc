#include "core/base/bytes_text.h"

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(BytesTextTest, HasThreeDigitsAndAUnit) {
  EXPECT_EQ(BytesText(0), "0 B");
  EXPECT_EQ(BytesText(999), "999 B");
  EXPECT_EQ(BytesText(1'234'567), "1.23 MB");
  EXPECT_EQ(BytesText(999'999), "1 MB");
  EXPECT_EQ(BytesText(45'600'000'000), "45.6 GB");
}

}  // namespace
}  // namespace tactus::internal
