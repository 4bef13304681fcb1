// A message was accepted if its capture time was later than that of the first
// frame of the message before, even if it was earlier than that of the last
// frame: time_since_onset went from 390 ms back to 1 ns.
#include <algorithm>
#include <vector>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kPeriodNs = 10'000'000;

class CaptureTimeRunsBackwardsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(session_.OnRequest(testing::ConfigRequest()).ok());
  }

  // `frames` touched frames from `time_ns` on.
  absl::Status Send(int frames, int64_t time_ns) {
    auto request = testing::DenseU16(
        sequence_, std::vector<testing::Counts>(static_cast<size_t>(frames),
                                                testing::Touch(1)));
    request.mutable_frames()->set_first_capture_time_ns(time_ns);
    sequence_ += static_cast<uint64_t>(frames);
    const absl::Status status = session_.OnRequest(request);
    session_.EndRequest(0, 1);
    return status;
  }

  // The largest step back of time_since_onset in the answers so far.
  int64_t LargestStepBack() {
    int64_t last = 0;
    int64_t back = 0;
    while (const auto* response = session_.responses().StartWrite(0)) {
      if (response->answer().contacts_size() > 0) {
        const int64_t time =
            response->answer().contacts(0).time_since_onset_ns();
        back = std::max(back, last - time);
        last = time;
      }
      session_.responses().FinishWrite();
    }
    return back;
  }

  testing::TestModels models_;
  StreamSession session_{&models_, {}};
  uint64_t sequence_ = 1;
};

TEST_F(CaptureTimeRunsBackwardsTest, IsRefused) {
  ASSERT_TRUE(Send(40, 0).ok());
  const absl::Status status = Send(1, 1);
  EXPECT_EQ(ReasonOf(status), "TIME_REGRESSION");
  EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(LargestStepBack(), 0);
}

TEST_F(CaptureTimeRunsBackwardsTest, TheLastFrameIsTheBound) {
  ASSERT_TRUE(Send(40, 0).ok());
  ASSERT_TRUE(Send(40, 39 * kPeriodNs + 1).ok());
  EXPECT_EQ(ReasonOf(Send(40, 39 * kPeriodNs + 1 + 39 * kPeriodNs)),
            "TIME_REGRESSION");
  EXPECT_EQ(LargestStepBack(), 0);
}

}  // namespace
}  // namespace tactus::internal::server
