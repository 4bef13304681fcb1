// 2,000 streams that never sent their config, all from one connection, took
// every place the server had for the idle timeout of 300 s: nobody else could
// open a stream. Health.Watch calls had no limit at all.
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "grpc/health/v1/health.pb.h"
#include "gtest/gtest.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Bystander;
using testing::ChildTactusd;
using testing::Eventually;
using testing::RawHttp2;
using testing::RawStream;
using testing::TestServer;

constexpr char kClassify[] = "/tactus.v1.ContactService/ClassifyContact";
constexpr char kWatch[] = "/grpc.health.v1.Health/Watch";

TEST(StreamsWithoutConfigTest, LeaveRoomAndGoAway) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  const double before = server.ResidentMib();
  RawHttp2 attacker(server.port());
  for (int i = 0; i < limits::kMaxStreams; ++i) attacker.Open(kClassify);
  ASSERT_TRUE(attacker.Flush());
  // Those beyond the limit of one peer are refused at once, the bystander and
  // the attacker being one peer here.
  constexpr int kRefused = limits::kMaxStreams - limits::kMaxStreamsPerPeer + 1;
  ASSERT_TRUE(attacker.ReadUntil(
      [&] { return attacker.received(RawHttp2::kHeaders) >= kRefused; },
      milliseconds(30'000)));
  EXPECT_TRUE(robot.IsServed());
  // The others end when their first message is due.
  EXPECT_TRUE(attacker.ReadUntil(
      [&] {
        return attacker.received(RawHttp2::kHeaders) >= limits::kMaxStreams;
      },
      milliseconds(30'000)));
  testing::ExpectGoodStream(Bystander::OwnConnection(server.address()),
                            testing::kModelWithoutPoses);
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(server.PeakIsBelow(100));
  EXPECT_TRUE(server.ResidentIsBelow(before + 50));
  EXPECT_TRUE(robot.Finish().ok());
}

server::TactusServer::Options OnLoopback() {
  return TestServer::OnLoopback(100);
}

TEST(StreamsWithoutConfigTest, OnePeerCannotTakeAllStreams) {
  server::TactusServer::Options options = OnLoopback();
  options.max_streams_per_peer = 2;
  TestServer server(options);
  RawStream first(server.channel());
  RawStream second(server.channel());
  ASSERT_TRUE(Eventually([&] { return server.server().gate().live() == 2; }));
  RawStream third(server.channel());
  const absl::Status status = third.Finish();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ReasonOf(status), "STREAM_LIMIT");
  EXPECT_EQ(InfoOf(status).metadata().at("peer"), "127.0.0.1");
  EXPECT_EQ(InfoOf(status).metadata().at("limit"), "2");
  // Another peer: the in-process channel.
  testing::ExpectGoodStream(server.server().InProcessChannel());
}

TEST(StreamsWithoutConfigTest, TheFirstMessageHasADeadline) {
  TestServer server({.first_message_timeout_ms = 50, .idle_timeout_ms = 0});
  RawStream robot(server.channel());
  ASSERT_TRUE(robot.Write(testing::ConfigRequest()));
  ASSERT_TRUE(robot.Read().has_started());
  RawStream silent(server.channel());
  const absl::Status status = silent.Finish();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(ReasonOf(status), "STREAM_IDLE");
  EXPECT_EQ(InfoOf(status).metadata().at("limit"), "50");
  // A stream that was configured may be silent for longer.
  std::this_thread::sleep_for(milliseconds(100));
  ASSERT_TRUE(robot.Write(testing::DenseU16(1, {testing::Touch(1)})));
  EXPECT_TRUE(robot.Read().has_answer());
  robot.HalfClose();
  EXPECT_TRUE(robot.Finish().ok());
}

// A HealthCheckRequest for `service`.
std::string Watch(const std::string& service) {
  grpc::health::v1::HealthCheckRequest request;
  request.set_service(service);
  return request.SerializeAsString();
}

TEST(StreamsWithoutConfigTest, WatchesAreBounded) {
  TestServer server(OnLoopback());
  RawHttp2 attacker(server.server().ports()[0]);
  const uint64_t limit = limits::kMaxWatchesPerPeer;
  for (uint64_t i = 0; i < 2 * limit; ++i) {
    ASSERT_TRUE(attacker.Message(attacker.Open(kWatch), Watch("")));
  }
  const auto& gate = server.server().watch_gate();
  EXPECT_TRUE(attacker.ReadUntil([&] { return gate.refused() >= limit; },
                                 milliseconds(30'000)));
  EXPECT_EQ(gate.live(), static_cast<int>(limit));
  EXPECT_EQ(gate.refused(), limit);
  testing::ExpectGoodStream(server.channel());
}

TEST(StreamsWithoutConfigTest, WatchesKeepNoLongNames) {
  TestServer server(OnLoopback());
  RawHttp2 attacker(server.server().ports()[0]);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(attacker.Message(attacker.Open(kWatch),
                                 Watch(std::string(100'000, 'x'))));
  }
  EXPECT_TRUE(attacker.ReadUntil(
      [&] { return attacker.received(RawHttp2::kHeaders) >= 3; },
      milliseconds(30'000)));
  EXPECT_EQ(server.server().watch_gate().opened(), 0u);
}

}  // namespace
}  // namespace tactus::internal
