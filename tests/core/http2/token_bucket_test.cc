#include "core/http2/token_bucket.h"

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

int Taken(TokenBucket& bucket, int tries, int64_t now_ns) {
  int taken = 0;
  for (int i = 0; i < tries; ++i) taken += bucket.Take(now_ns) ? 1 : 0;
  return taken;
}

TEST(TokenBucketTest, BurstThenRate) {
  TokenBucket bucket({.per_second = 10, .burst = 100});
  EXPECT_EQ(Taken(bucket, 1000, 5 * kSecond), 100);
  EXPECT_EQ(Taken(bucket, 1000, 6 * kSecond), 10);
  EXPECT_EQ(Taken(bucket, 1000, 6 * kSecond), 0);
  // A silence fills it to the burst and no further.
  EXPECT_EQ(Taken(bucket, 1000, 1000 * kSecond), 100);
}

TEST(TokenBucketTest, AClockThatStepsBackGivesNothing) {
  TokenBucket bucket({.per_second = 10, .burst = 5});
  EXPECT_EQ(Taken(bucket, 10, 10 * kSecond), 5);
  EXPECT_EQ(Taken(bucket, 10, 9 * kSecond), 0);
}

}  // namespace
}  // namespace tactus::internal
