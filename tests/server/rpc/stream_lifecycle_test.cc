// Streams that are cancelled, refused, silent or read slowly: each of them
// ends, and the server counts each end.
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using testing::ConfigRequest;
using testing::DenseU16;
using testing::EndOfTrialRequest;
using testing::Eventually;
using testing::ExpectGoodStream;
using testing::RawStream;
using testing::TestServer;
using testing::Touch;

bool IsBalanced(TestServer& server) {
  const server::StreamGate& gate = server.server().gate();
  return gate.live() == 0 && gate.opened() == gate.closed();
}

// Takes a stream to one of its states, from before config to after half-close.
constexpr int kStates = 6;
void GoTo(int state, RawStream& stream) {
  if (state >= 1) stream.Write(ConfigRequest());
  if (state >= 2) stream.Read();
  if (state >= 3) stream.Write(DenseU16(1, {Touch(1), Touch(1)}));
  if (state >= 4) stream.Write(EndOfTrialRequest());
  if (state >= 5) stream.HalfClose();
}

TEST(StreamLifecycleTest, CancelAtEveryState) {
  TestServer server;
  for (int round = 0; round < 20; ++round) {
    for (int state = 0; state < kStates; ++state) {
      RawStream stream(server.channel());
      GoTo(state, stream);
      stream.Cancel();
      const absl::Status status = stream.Finish();
      // After the half-close, the stream may end before it is cancelled.
      EXPECT_TRUE(status.code() == absl::StatusCode::kCancelled ||
                  (state == 5 && status.ok()))
          << "state " << state << ": " << status;
    }
  }
  ExpectGoodStream(server.channel());
  EXPECT_TRUE(Eventually([&] { return IsBalanced(server); }));
}

TEST(StreamLifecycleTest, DeadlineAtEveryState) {
  TestServer server;
  for (int state = 0; state < kStates - 1; ++state) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::milliseconds(30));
    auto stub = v1::ContactService::NewStub(server.channel());
    auto rpc = stub->ClassifyContact(&context);
    if (state >= 1) rpc->Write(ConfigRequest());
    if (state >= 2) rpc->Write(DenseU16(1, {Touch(1)}));
    if (state >= 3) rpc->Write(EndOfTrialRequest());
    v1::ClassifyContactResponse response;
    while (rpc->Read(&response)) {
    }
    EXPECT_EQ(rpc->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  }
  EXPECT_TRUE(Eventually([&] { return IsBalanced(server); }));
}

TEST(StreamLifecycleTest, ManyStreamsEndedAtRandomBalance) {
  TestServer server;
  std::vector<std::thread> threads;
  for (int worker = 0; worker < 4; ++worker) {
    threads.emplace_back([&server, worker] {
      Random random(worker);
      for (int i = 0; i < 150; ++i) {
        RawStream stream(server.channel());
        const int state = static_cast<int>(random.Index(kStates));
        GoTo(state, stream);
        // Nothing may be written after the half-close of the last state.
        switch (state == kStates - 1 ? random.Index(2) * 3 : random.Index(3)) {
          case 0:
            stream.Cancel();
            break;
          case 1:
            stream.HalfClose();
            break;
          case 2:
            stream.Write(v1::ClassifyContactRequest());
            break;
          default:
            break;
        }
        stream.Finish().IgnoreError();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(Eventually([&] { return IsBalanced(server); }));
  // A stream cancelled at once may never reach the server.
  EXPECT_GT(server.server().gate().opened(), 300u);
  // No stream still holds its model. The last one releases it just after the
  // gate has counted its end.
  EXPECT_TRUE(
      Eventually([&] { return server.models().model().use_count() == 1; }));
}

TEST(StreamLifecycleTest, ServerGoneWithStreamsOpen) {
  auto server = std::make_unique<TestServer>();
  std::vector<std::unique_ptr<RawStream>> streams;
  for (int state = 0; state < kStates - 1; ++state) {
    streams.push_back(std::make_unique<RawStream>(server->channel()));
    GoTo(state, *streams.back());
  }
  server.reset();
  for (auto& stream : streams) EXPECT_FALSE(stream->Finish().ok());
}

TEST(StreamLifecycleTest, WhatStreamsSkippedIsAddedUpAtTheirEnds) {
  TestServer server;
  for (int i = 0; i < 3; ++i) {
    RawStream stream(server.channel());
    stream.Write(ConfigRequest());
    stream.Write(testing::SparseU16(1, std::vector(5, testing::Untouched())));
    EXPECT_EQ(server.server().skipped().total(SkipRule::kUntouchedFrames),
              5u * i);
    stream.HalfClose();
    EXPECT_TRUE(stream.Finish().ok());
    ASSERT_TRUE(Eventually([&] { return server.server().gate().live() == 0; }));
  }
  EXPECT_EQ(server.server().skipped().total(SkipRule::kUntouchedFrames), 15u);
  EXPECT_EQ(server.server().skipped().total(SkipRule::kUnlistedTaxels), 15u);
  EXPECT_NE(server.server().skipped().ToString().find("15 untouched frames"),
            std::string::npos);
}

TEST(StreamLifecycleTest, StreamsBeyondTheLimitAreRefused) {
  TestServer server({.max_streams = 2});
  auto first = std::make_unique<RawStream>(server.channel());
  GoTo(2, *first);
  RawStream second(server.channel());
  GoTo(2, second);
  RawStream third(server.channel());
  const absl::Status status = third.Finish();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ReasonOf(status), "STREAM_LIMIT");
  EXPECT_EQ(InfoOf(status).metadata().at("limit"), "2");
  EXPECT_EQ(server.server().gate().refused(), 1u);
  first.reset();
  EXPECT_TRUE(Eventually([&] { return server.server().gate().live() == 1; }));
  ExpectGoodStream(server.channel());
}

TEST(StreamLifecycleTest, SilenceEndsAStreamWithItsFinal) {
  TestServer server({.idle_timeout_ms = 100});
  RawStream silent(server.channel());
  const absl::Status before_config = silent.Finish();
  EXPECT_EQ(before_config.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(ReasonOf(before_config), "STREAM_IDLE");

  RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(ConfigRequest()));
  EXPECT_EQ(stream.Read().started().limits().idle_timeout_ms(), 100u);
  ASSERT_TRUE(stream.Write(DenseU16(1, {Touch(1)})));
  const absl::Status status = stream.Finish();
  EXPECT_EQ(ReasonOf(status), "STREAM_IDLE");
  ASSERT_FALSE(stream.rest().empty());
  EXPECT_TRUE(stream.rest().back().answer().is_final());
  EXPECT_TRUE(Eventually([&] { return IsBalanced(server); }));
}

TEST(StreamLifecycleTest, FramesKeepAStreamFromBeingIdle) {
  TestServer server({.idle_timeout_ms = 400});
  RawStream stream(server.channel());
  GoTo(2, stream);
  for (uint64_t sequence = 1; sequence <= 30; ++sequence) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    ASSERT_TRUE(stream.Write(DenseU16(sequence, {Touch(1)})));
    ASSERT_EQ(stream.Read().answer().sequence(), sequence);
  }
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
}

// A client that does not read: the server drops interim answers, keeps final
// ones, and stops reading. When the client reads again, it gets all finals.
TEST(StreamLifecycleTest, SlowReaderLosesInterimsOnly) {
  TestServer server;
  RawStream stream(server.channel());
  GoTo(2, stream);
  constexpr int kTrials = 300;
  // Blocks once the server stops reading.
  std::thread writer([&] {
    uint64_t sequence = 1;
    for (int trial = 0; trial < kTrials; ++trial) {
      for (int message = 0; message < 4; ++message) {
        stream.Write(DenseU16(sequence, std::vector(40, Touch(1))));
        sequence += 40;
      }
      stream.Write(EndOfTrialRequest());
    }
    stream.HalfClose();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const absl::Status status = stream.Finish();
  writer.join();
  EXPECT_TRUE(status.ok()) << status;
  int finals = 0;
  int interims = 0;
  uint64_t last = 0;
  uint64_t superseded = 0;
  for (const auto& response : stream.rest()) {
    const v1::Answer& p = response.answer();
    // A final repeats the sequence of the frame before it.
    EXPECT_GE(p.sequence(), last);
    last = p.sequence();
    superseded = p.superseded();
    finals += p.is_final();
    interims += !p.is_final();
  }
  EXPECT_EQ(finals, kTrials);
  EXPECT_EQ(last, kTrials * 160u);
  EXPECT_EQ(interims + superseded, kTrials * 160u);
}

}  // namespace
}  // namespace tactus::internal
