// Every row of the bad-input table against a session without transport.
#include "tests/server/support/bad_input.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

using testing::BadInput;

class BadInputTest : public ::testing::TestWithParam<BadInput> {
 protected:
  static const testing::TestModels& models() {
    static const auto* const models = new testing::TestModels();
    return *models;
  }
};

TEST_P(BadInputTest, EndsTheSessionWithItsReason) {
  const BadInput& bad = GetParam();
  StreamSession session(&models(), {});
  for (size_t i = 0; i < bad.requests.size(); ++i) {
    const absl::Status status = session.OnRequest(bad.requests[i]);
    const bool is_bad = !bad.half_close && i + 1 == bad.requests.size();
    EXPECT_EQ(status.ok(), !is_bad) << "request " << i << ": " << status;
  }
  if (bad.half_close) session.OnHalfClose();
  const absl::Status status = session.final_status();
  EXPECT_EQ(status.code(), bad.code) << status;
  EXPECT_EQ(ReasonOf(status), bad.reason) << status;
  EXPECT_EQ(InfoOf(status).domain(), "tactus");
  EXPECT_FALSE(session.wants_request());
  EXPECT_EQ(ReasonOf(session.OnRequest(testing::EndOfTrialRequest())),
            "STREAM_FINISHED");
}

// A bad message must leave no trace of its good part.
TEST_P(BadInputTest, UsesNoFrameOfABadMessage) {
  const BadInput& bad = GetParam();
  if (bad.half_close) return;
  StreamSession session(&models(), {});
  uint64_t good = 0;
  for (size_t i = 0; i + 1 < bad.requests.size(); ++i) {
    ASSERT_TRUE(session.OnRequest(bad.requests[i]).ok());
    good += bad.requests[i].frames().frame_count();
  }
  ASSERT_FALSE(session.OnRequest(bad.requests.back()).ok());
  EXPECT_EQ(session.frames(), good);
}

INSTANTIATE_TEST_SUITE_P(Table, BadInputTest,
                         ::testing::ValuesIn(testing::BadInputs()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace tactus::internal::server
