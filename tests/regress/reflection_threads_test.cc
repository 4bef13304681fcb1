// Reflection is a synchronous service: each open call held a thread, so 1,500
// half-open calls took 1,511 threads. Reflection is off by default, and the
// number of its threads has a limit.
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "server/ops/health_probe.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Bystander;
using testing::ChildTactusd;
using testing::RawHttp2;

constexpr char kReflectionMethod[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
constexpr int kReflectionCalls = 1'000;

class ReflectionThreadsTest : public ::testing::TestWithParam<bool> {};

TEST_P(ReflectionThreadsTest, AreBounded) {
  const bool on = GetParam();
  ChildTactusd server(on ? std::vector<std::string>{"--reflection"}
                         : std::vector<std::string>{});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  const int threads = server.Threads();
  RawHttp2 attacker(server.port());
  for (int i = 0; i < kReflectionCalls; ++i) attacker.Open(kReflectionMethod);
  ASSERT_TRUE(attacker.Flush());
  // Those that get no thread are refused, all of them without reflection.
  const int refused =
      on ? kReflectionCalls - limits::kMaxSyncThreads : kReflectionCalls;
  EXPECT_TRUE(attacker.ReadUntil(
      [&] { return attacker.received(RawHttp2::kHeaders) >= refused; },
      milliseconds(30'000)));
  // gRPC's own executor may have begun a few threads for the connection.
  EXPECT_LE(server.Threads(), threads + (on ? limits::kMaxSyncThreads : 0) + 8);
  EXPECT_TRUE(robot.IsServed());
  const auto channel = Bystander::OwnConnection(server.address());
  testing::ExpectGoodStream(channel, testing::kModelWithoutPoses);
  // A probe of a container must not fail because of it.
  const auto serving = server::ProbeHealth(channel, "", milliseconds(10'000));
  EXPECT_TRUE(serving.ok() && *serving) << serving.status();
  EXPECT_TRUE(server.PeakIsBelow(100));
  EXPECT_TRUE(robot.Finish().ok());
}

INSTANTIATE_TEST_SUITE_P(Reflection, ReflectionThreadsTest, ::testing::Bool(),
                         [](const auto& info) {
                           return info.param ? "On" : "Off";
                         });

}  // namespace
}  // namespace tactus::internal
