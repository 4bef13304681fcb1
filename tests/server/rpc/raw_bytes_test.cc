// Bytes that are no message, and messages larger than any may be.
#include <string>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "google/protobuf/wrappers.pb.h"
#include "grpcpp/generic/generic_stub.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"

namespace tactus {
namespace {

// Sends `bytes` as the first message of `method`; how the RPC ends.
absl::Status Call(const std::shared_ptr<grpc::Channel>& channel,
                  const std::string& method, const std::string& bytes) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  const auto next = [&queue] {
    void* tag;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  auto rpc = stub.PrepareCall(&context, method, &queue);
  rpc->StartCall(nullptr);
  next();
  const grpc::Slice slice(bytes);
  rpc->Write(grpc::ByteBuffer(&slice, 1), nullptr);
  next();
  grpc::ByteBuffer answer;
  do {
    rpc->Read(&answer, nullptr);
  } while (next());
  grpc::Status status;
  rpc->Finish(&status, nullptr);
  next();
  return client::FromGrpcStatus(status);
}

class RawBytesTest : public ::testing::Test {
 protected:
  absl::Status Classify(const std::string& bytes) {
    return Call(server_.channel(), "/tactus.v1.ContactService/ClassifyContact",
                bytes);
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

TEST_F(RawBytesTest, BeyondGrpcsOwnLimit) {
  const absl::Status status = Classify(std::string(5 << 20, '\xff'));
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  testing::ExpectGoodStream(server_.channel());
}

TEST_F(RawBytesTest, MethodsThatDoNotExistYet) {
  for (const char* method :
       {"/tactus.v1.ModelService/ListModels", "/tactus.v1.NoService/NoMethod",
        "/tactus.v1.ContactService/ClassifyTrial"}) {
    const absl::Status status = Call(server_.channel(), method, "");
    EXPECT_EQ(status.code(), absl::StatusCode::kUnimplemented);
    EXPECT_EQ(ReasonOf(status), "UNIMPLEMENTED") << status;
    EXPECT_EQ(InfoOf(status).metadata().at("rpc"), method);
  }
}

}  // namespace
}  // namespace tactus
