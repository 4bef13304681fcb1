#include "client/training/retry.h"

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;

TEST(RetryTest, OnlyBrokenCallsAreRepeated) {
  EXPECT_TRUE(MayRetry(absl::UnavailableError("")));
  EXPECT_TRUE(MayRetry(Draining()));
  EXPECT_TRUE(MayRetry(UploadBusy("uploads/1")));
  EXPECT_TRUE(MayRetry(NoResponse("x", 1)));
  EXPECT_TRUE(MayRetry(absl::InternalError("stream reset")));
  EXPECT_TRUE(MayRetry(absl::CancelledError("")));
  EXPECT_FALSE(MayRetry(absl::OkStatus()));
  EXPECT_FALSE(MayRetry(EtagMismatch("a", "b", "c")));
  EXPECT_FALSE(MayRetry(JobLimit(3)));
  EXPECT_FALSE(MayRetry(WorkCancelled("job")));
  EXPECT_FALSE(MayRetry(InvalidResponse("a", "b", "c")));
  EXPECT_FALSE(MayRetry(absl::UnimplementedError("")));
}

TEST(RetryTest, WaitsDoubleUpToALimit) {
  std::vector<int64_t> waits;
  Retries retries(
      {.limit = 11,
       .sleep = [&](milliseconds wait) { waits.push_back(wait.count()); }},
      5);
  const absl::Status broken = absl::UnavailableError("broken");
  for (int i = 0; i < 11; ++i) EXPECT_TRUE(retries.Wait(broken).ok());
  EXPECT_EQ(retries.Wait(broken), broken);
  ASSERT_EQ(waits.size(), 11u);
  const int64_t longest[] = {25,   50,   100,  200,  400, 800,
                             1600, 3200, 5000, 5000, 5000};
  for (int i = 0; i < 11; ++i) {
    EXPECT_GE(2 * waits[i] + 1, longest[i]);
    EXPECT_LE(waits[i], longest[i]);
  }
  retries.Reset();
  EXPECT_TRUE(retries.Wait(broken).ok());
  EXPECT_LE(waits.back(), 25);
}

TEST(RetryTest, ACallIsRepeatedUntilItArrives) {
  const RetryOptions options = {.limit = 3, .sleep = [](milliseconds) {}};
  int calls = 0;
  const auto third = [&]() -> absl::StatusOr<int> {
    if (++calls < 3) return absl::UnavailableError("broken");
    return calls;
  };
  EXPECT_EQ(Repeated(options, third).value(), 3);
  const auto never = [&]() -> absl::StatusOr<int> {
    ++calls;
    return absl::UnavailableError("broken");
  };
  calls = 0;
  EXPECT_FALSE(Repeated(options, never).ok());
  EXPECT_EQ(calls, 4);
  const auto refused = [&]() -> absl::StatusOr<int> {
    ++calls;
    return JobLimit(3);
  };
  calls = 0;
  EXPECT_EQ(ReasonOf(Repeated(options, refused).status()), "JOB_LIMIT");
  EXPECT_EQ(calls, 1);
}

TEST(RetryTest, ClientsWaitDifferently) {
  Backoff a(1);
  Backoff b(2);
  EXPECT_NE(a.Next(), b.Next());
  EXPECT_EQ(Backoff(3).Next(), Backoff(3).Next());
}

}  // namespace
}  // namespace tactus::internal::client
