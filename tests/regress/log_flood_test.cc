// gRPC logs a line for each header that it cannot parse, with what the peer
// sent in it: a peer could fill the disk with the log, and forge lines in it.
#include <algorithm>
#include <sstream>
#include <string>

#include "gtest/gtest.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Bystander;
using testing::ChildTactusd;
using testing::RawHttp2;

constexpr int kCalls = 5'000;

TEST(LogFloodTest, MalformedHeadersDoNotFloodTheLog) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  RawHttp2 attacker(server.port());
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kCalls; ++i) {
    attacker.Open("/tactus.v1.ContactService/ClassifyContact",
                  {{"grpc-timeout", "soon\nforged"},
                   {"grpc-encoding", "\x1b[31m"},
                   {"content-type", std::string(1000, 'x')}});
    if (i % 100 == 0) {
      attacker.Flush();
      attacker.ReadFor(milliseconds(1));
    }
  }
  attacker.Flush();
  attacker.ReadFor(milliseconds(300));
  EXPECT_TRUE(robot.IsServed());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::steady_clock::now() - begin);
  const std::string log = server.Log();
  const auto lines = std::count(log.begin(), log.end(), '\n');
  // gRPC may log 100 lines at first, then 10 per second; ends of streams 200,
  // then 20 per second. The server's start logs a few.
  const int64_t most = 300 + (seconds.count() + 2) * 30 + 20;
  EXPECT_LT(lines, most);
  EXPECT_LT(log.size(), static_cast<size_t>(most) * 9'000);
  EXPECT_EQ(log.find('\x1b'), std::string::npos);
  EXPECT_EQ(log.find("\nforged"), std::string::npos);
  // While the server still ends the attacker's calls, it may refuse new ones.
  EXPECT_TRUE(testing::Eventually([&] {
    Bystander late(server.address());
    return late.IsServed(1);
  }));
  EXPECT_TRUE(robot.Finish().ok());
}

// protobuf writes to standard error for every text field that is not UTF-8: a
// stranger's health checks made thousands of lines, in another form.
TEST(LogFloodTest, TextThatIsNotUtf8DoesNotFloodTheLog) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  const auto begin = std::chrono::steady_clock::now();
  RawHttp2 stranger(server.port());
  for (int i = 0; i < 2'000; ++i) {
    const uint32_t call = stranger.Open("/grpc.health.v1.Health/Check");
    // HealthCheckRequest.service.
    ASSERT_TRUE(stranger.Message(call, "\x0a\x04\xff\xfe\xff\xfe"));
    stranger.Frame(RawHttp2::kData, RawHttp2::kEndStream, call, "");
    if (i % 50 == 0) stranger.ReadFor(milliseconds(1));
  }
  stranger.Flush();
  stranger.ReadFor(milliseconds(300));
  Bystander robot(server.address());
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::steady_clock::now() - begin);
  std::istringstream log(server.Log());
  int protobuf = 0;
  for (std::string line; std::getline(log, line);) {
    EXPECT_EQ(line.find("20"), 0u) << "no time stands before: " << line;
    if (line.find("UTF-8") != std::string::npos) ++protobuf;
  }
  EXPECT_GT(protobuf, 0) << "the test does not reach protobuf";
  EXPECT_LE(protobuf, 100 + (seconds.count() + 2) * 10);
}

}  // namespace
}  // namespace tactus::internal
