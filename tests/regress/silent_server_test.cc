// A server that kept its connection alive and sent nothing made tactus-stream
// wait without end, because no call of the client had a deadline.
#include <chrono>

#include "client/drivers/sim_driver.h"
#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/support/ping_only_peer.h"
#include "tests/support/scripted_server.h"
#include "tests/support/time_limit.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

using testing::GoodAnswer;
using testing::GoodStarted;
using testing::ScriptedServer;
using testing::TimeLimit;
using Stream = ScriptedServer::Stream;

constexpr std::chrono::milliseconds kShort(50);

v1::StreamConfig GoodConfig() { return testing::ConfigRequest().config(); }
void Ignore(const v1::ClassifyContactResponse&) {}

// Reads the configuration and accepts it.
void Accept(Stream* stream) {
  v1::ClassifyContactRequest request;
  stream->Read(&request);
  stream->Write(GoodStarted());
}

TEST(SilentServerTest, OpenReturnsThoughOnlyPingsAreAnswered) {
  testing::PingOnlyPeer peer;
  const TimeLimit limit("Open() waits", [&] { peer.Stop(); });
  const auto stream =
      ContactStream::Open(MakeChannel(peer.address()), GoodConfig(), Ignore,
                          {.open = std::chrono::milliseconds(500)});
  EXPECT_EQ(stream.status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(ReasonOf(stream.status()), "NO_RESPONSE");
  EXPECT_EQ(stream.status().message().find(
                "the server did not respond to config within 500 ms"),
            0u);
  EXPECT_GT(peer.headers(), 0);
}

TEST(SilentServerTest, OpenReturnsThoughTheServerNeverStartsTheStream) {
  ScriptedServer server([](grpc::ServerContext* context, Stream*) {
    return ScriptedServer::SayNothing(context);
  });
  const TimeLimit limit("Open() waits", [&] { server.Stop(); });
  const auto stream =
      ContactStream::Open(MakeChannel(server.address()), GoodConfig(), Ignore,
                          {.open = std::chrono::milliseconds(500)});
  EXPECT_EQ(ReasonOf(stream.status()), "NO_RESPONSE") << stream.status();
}

TEST(SilentServerTest, EndTrialReturnsWithoutAFinalPosterior) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    Accept(stream);
    return ScriptedServer::SayNothing(context);
  });
  const TimeLimit limit("EndTrial() waits", [&] { server.Stop(); });
  auto stream =
      *ContactStream::Open(MakeChannel(server.address()), GoodConfig(), Ignore,
                           {.final_answer = kShort});
  const absl::Status status = stream->EndTrial().status();
  EXPECT_EQ(ReasonOf(status), "NO_RESPONSE") << status;
  // The status stays.
  EXPECT_EQ(stream->EndTrial().status(), status);
  EXPECT_EQ(stream->Send(testing::EndOfTrialRequest()), status);
  EXPECT_EQ(stream->Close(), status);
  EXPECT_TRUE(stream->ended());
}

TEST(SilentServerTest, CloseReturnsWithoutAStatus) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    Accept(stream);
    return ScriptedServer::SayNothing(context);
  });
  const TimeLimit limit("Close() waits", [&] { server.Stop(); });
  auto stream = *ContactStream::Open(MakeChannel(server.address()),
                                     GoodConfig(), Ignore, {.close = kShort});
  EXPECT_EQ(ReasonOf(stream->Close()), "NO_RESPONSE");
}

TEST(SilentServerTest, SendReturnsThoughTheServerReadsNothing) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    Accept(stream);
    return ScriptedServer::SayNothing(context);
  });
  const TimeLimit limit("Send() waits", [&] { server.Stop(); });
  auto stream = *ContactStream::Open(MakeChannel(server.address()),
                                     GoodConfig(), Ignore, {.send = kShort});
  const std::vector<testing::Counts> frames(40, testing::Touch(1));
  absl::Status status;
  // 30 kB each: more than any window for flow control.
  for (uint64_t i = 0; i < 1000 && status.ok(); ++i) {
    status = stream->Send(testing::DenseU16(40 * i + 1, frames));
  }
  EXPECT_EQ(ReasonOf(status), "NO_RESPONSE") << status;
}

TEST(SilentServerTest, TheTrialPlayerReturnsWithoutAnswers) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    Accept(stream);
    return ScriptedServer::SayNothing(context);
  });
  const TimeLimit limit("Run() waits", [&] { server.Stop(); });
  SimDriver driver({.seed = 1}, 1, {});
  TrialPlayer player(MakeChannel(server.address()), &driver,
                     {.timeouts = {.final_answer = kShort}},
                     [](const TrialResult&) {});
  EXPECT_EQ(ReasonOf(player.Run()), "NO_RESPONSE");
}

TEST(SilentServerTest, AServerThatAnswersInTimeIsNotCancelled) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    Accept(stream);
    v1::ClassifyContactRequest request;
    uint64_t sequence = 0;
    while (stream->Read(&request)) {
      if (request.has_frames()) {
        sequence = request.frames().first_sequence();
        continue;
      }
      v1::ClassifyContactResponse response = GoodAnswer(sequence);
      response.mutable_answer()->set_is_final(true);
      stream->Write(response);
    }
    return grpc::Status::OK;
  });
  auto stream =
      *ContactStream::Open(MakeChannel(server.address()), GoodConfig(), Ignore);
  for (uint64_t trial = 1; trial <= 5; ++trial) {
    ASSERT_TRUE(
        stream->Send(testing::DenseU16(trial, {testing::Touch(1)})).ok());
    const auto answer = stream->EndTrial();
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->sequence(), trial);
  }
  EXPECT_TRUE(stream->Close().ok());
}

}  // namespace
}  // namespace tactus::internal::client
