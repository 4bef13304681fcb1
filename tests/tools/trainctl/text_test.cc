#include "tools/trainctl/text.h"

#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

TEST(TextTest, TimesAndSizesAreShort) {
  EXPECT_EQ(ClockText(0), "0:00");
  EXPECT_EQ(ClockText(64.2), "1:05");
  EXPECT_EQ(ClockText(7380), "2:03:00");
  EXPECT_EQ(TimeText(0), "1970-01-01 00:00:00");
  EXPECT_EQ(TimeText(951'782'400'999), "2000-02-29 00:00:00");
}

}  // namespace
}  // namespace tactus::internal::client
