#include "server/jobs/retry_log.h"

#include <vector>

#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

// A job whose end could not be stored wrote a line each second.
TEST(RetryLogTest, ANightOfFailuresIsSeventeenLines) {
  RetryLog log;
  int lines = 0;
  for (int second = 0; second < 24 * 3'600; ++second) lines += log.Fails();
  EXPECT_EQ(lines, 17);
  log.Succeeds();
  EXPECT_TRUE(log.Fails()) << "the next failure is told at once";
  EXPECT_EQ(log.failures(), 1u);
}

}  // namespace
}  // namespace tactus::internal::server
