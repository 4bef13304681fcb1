// ClassifyTrial over gRPC: the final of a stream, its errors, and streams that
// do not wait for trials.
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyTrial";

v1::ClassifyTrialRequest Trial(int frames, uint64_t seed) {
  v1::ClassifyTrialRequest request;
  *request.mutable_config() = testing::ConfigRequest().config();
  uint64_t sequence = 1;
  for (const testing::Counts& frame : testing::Contact(frames, seed)) {
    *request.add_frames() = testing::DenseU16(sequence++, {frame}).frames();
  }
  return request;
}

class ClassifyTrialTest : public ::testing::Test {
 protected:
  absl::Status Classify(const v1::ClassifyTrialRequest& request) {
    const auto stub = v1::ContactService::NewStub(server_.channel());
    grpc::ClientContext context;
    response_.Clear();
    return client::FromGrpcStatus(
        stub->ClassifyTrial(&context, request, &response_));
  }

  testing::TestServer server_;
  v1::ClassifyTrialResponse response_;
};

TEST_F(ClassifyTrialTest, GetsTheFinalOfAStream) {
  const v1::ClassifyTrialRequest trial = Trial(100, 3);
  const absl::Status status = Classify(trial);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(response_.started().model_version(), "models/default/versions/1");
  EXPECT_TRUE(testing::Eventually(
      [&] { return server_.server().gate().frames() == 100u; }));

  testing::RawStream stream(server_.channel());
  v1::ClassifyContactRequest request;
  *request.mutable_config() = trial.config();
  ASSERT_TRUE(stream.Write(request));
  for (const v1::FrameBatch& batch : trial.frames()) {
    *request.mutable_frames() = batch;
    ASSERT_TRUE(stream.Write(request));
  }
  stream.HalfClose();
  ASSERT_TRUE(stream.Finish().ok());
  v1::Answer want = stream.rest().back().answer();
  ASSERT_TRUE(want.is_final());
  want.clear_superseded();
  EXPECT_EQ(response_.answer().SerializeAsString(), want.SerializeAsString());
}

TEST_F(ClassifyTrialTest, AsLargeAsATrialMayBe) {
  v1::ClassifyTrialRequest trial = Trial(165, 4);
  ASSERT_GT(trial.ByteSizeLong(), limits::kMaxTrialBytes - 4096);
  ASSERT_LE(trial.ByteSizeLong(), limits::kMaxTrialBytes);
  EXPECT_TRUE(Classify(trial).ok());
}

TEST_F(ClassifyTrialTest, TooManyBytesAreRefused) {
  const absl::Status status = Classify(Trial(400, 4));
  EXPECT_FALSE(status.ok());
  EXPECT_TRUE(
      testing::Eventually([&] { return server_.server().gate().live() == 0; }));
  testing::ExpectGoodStream(server_.channel());
}

TEST_F(ClassifyTrialTest, ErrorsCarryTheirReason) {
  v1::ClassifyTrialRequest trial = Trial(10, 1);
  trial.mutable_config()->set_model("no-such-model");
  absl::Status status = Classify(trial);
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReasonOf(status), "MODEL_NOT_FOUND") << status;
  status = testing::RawCall(server_.channel(), kMethod, "hello, robot").status;
  EXPECT_EQ(ReasonOf(status), "MALFORMED_REQUEST") << status;
  EXPECT_TRUE(
      testing::Eventually([&] { return server_.server().gate().live() == 0; }));
  testing::ExpectGoodStream(server_.channel());
}

// Trials from several threads while a stream is served; all get their answers.
TEST_F(ClassifyTrialTest, RunsBesideStreams) {
  std::vector<std::thread> threads;
  std::vector<std::string> answers(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      const auto stub = v1::ContactService::NewStub(server_.channel());
      const v1::ClassifyTrialRequest trial = Trial(150, 7);
      for (int k = 0; k < 10; ++k) {
        grpc::ClientContext context;
        v1::ClassifyTrialResponse response;
        ASSERT_TRUE(stub->ClassifyTrial(&context, trial, &response).ok());
        answers[i] = response.answer().SerializeAsString();
      }
    });
  }
  for (int k = 0; k < 20; ++k) testing::ExpectGoodStream(server_.channel());
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(answers[0].empty());
  for (const std::string& answer : answers) EXPECT_EQ(answer, answers[0]);
}

TEST(ClassifyTrialDrainTest, ADrainingServerRefuses) {
  testing::TestServer server(testing::TestServer::OnLoopback(60'000));
  testing::RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(testing::ConfigRequest()));
  ASSERT_TRUE(stream.Read().has_started());
  std::thread stop([&] { server.server().Stop(); });
  ASSERT_TRUE(stream.Read().has_notice());
  const auto status = testing::RawCall(server.channel(), kMethod,
                                       Trial(1, 1).SerializeAsString())
                          .status;
  EXPECT_EQ(ReasonOf(status), "DRAINING") << status;
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  stop.join();
}

}  // namespace
}  // namespace tactus::internal
