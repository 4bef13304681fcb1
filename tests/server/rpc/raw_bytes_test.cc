// The server refuses bytes that are no message, and messages that are too
// large.
#include <string>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

class RawBytesTest : public ::testing::Test {
 protected:
  absl::Status Classify(const std::string& bytes) {
    return testing::RawCall(server_.channel(),
                            "/tactus.v1.ContactService/ClassifyContact", bytes)
        .status;
  }
  testing::TestServer server_;
};

TEST_F(RawBytesTest, BytesThatAreNoMessage) {
  for (const std::string& bytes :
       {std::string("\xff\xff\xff\xff"), std::string("\x0a\x7f"),
        std::string(100, '\x07'), std::string("hello, robot")}) {
    const absl::Status status = Classify(bytes);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(ReasonOf(status), "MALFORMED_REQUEST") << status;
  }
  testing::ExpectGoodStream(server_.channel());
}

TEST_F(RawBytesTest, NameThatIsNotUtf8) {
  auto request = testing::ConfigRequest();
  request.mutable_config()->set_model("ab");
  std::string bytes = request.SerializeAsString();
  bytes[bytes.find("ab")] = '\xc3';
  EXPECT_EQ(ReasonOf(Classify(bytes)), "MALFORMED_REQUEST");
}

TEST_F(RawBytesTest, NoBytesAreAnEmptyRequest) {
  EXPECT_EQ(ReasonOf(Classify("")), "EMPTY_REQUEST");
}

TEST_F(RawBytesTest, TooManyBytesAreNotEvenParsed) {
  const absl::Status status =
      Classify(std::string(limits::kMaxMessageBytes + 1, '\xff'));
  EXPECT_EQ(ReasonOf(status), "MESSAGE_TOO_LARGE") << status;
}

TEST_F(RawBytesTest, BeyondTheLimitOfGrpc) {
  const absl::Status status = Classify(std::string(5 << 20, '\xff'));
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  testing::ExpectGoodStream(server_.channel());
}

}  // namespace
}  // namespace tactus::internal
