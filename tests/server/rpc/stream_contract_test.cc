// Every row of the bad-input table over gRPC: the right code, the right
// reason in the details, and a good stream afterwards.
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/bad_input.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using testing::BadInput;
using testing::RawStream;

testing::TestServer& Server() {
  static auto* const server = new testing::TestServer();
  return *server;
}

class StreamContractTest : public ::testing::TestWithParam<BadInput> {};

TEST_P(StreamContractTest, BadInputMeetsItsReasonAndHarmsNobody) {
  const BadInput& bad = GetParam();
  const auto& channel = Server().channel();
  // A stream that was open before continues beside the bad one.
  RawStream bystander(channel);
  ASSERT_TRUE(bystander.Write(testing::ConfigRequest()));
  ASSERT_TRUE(bystander.Read().has_started());

  RawStream stream(channel);
  for (const auto& request : bad.requests) {
    if (!stream.Write(request)) break;
  }
  if (bad.half_close) stream.HalfClose();
  const absl::Status status = stream.Finish();
  EXPECT_EQ(status.code(), bad.code) << status;
  EXPECT_EQ(ReasonOf(status), bad.reason) << status;
  EXPECT_EQ(InfoOf(status).domain(), "tactus");
  EXPECT_FALSE(status.message().empty());

  ASSERT_TRUE(bystander.Write(testing::DenseU16(1, {testing::Touch(1)})));
  EXPECT_EQ(bystander.Read().answer().sequence(), 1u);
  bystander.HalfClose();
  EXPECT_TRUE(bystander.Finish().ok());
  testing::ExpectGoodStream(channel);
  EXPECT_TRUE(
      testing::Eventually([] { return Server().server().gate().live() == 0; }));
}

INSTANTIATE_TEST_SUITE_P(Table, StreamContractTest,
                         ::testing::ValuesIn(testing::BadInputs()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace tactus::internal
