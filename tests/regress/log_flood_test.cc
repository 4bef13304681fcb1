// gRPC logs a line for each header that it cannot parse, with what the peer
// sent in it: a peer could fill the disk with the log, and forge lines in it.
#include <algorithm>
#include <string>

#include "gtest/gtest.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus {
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

}  // namespace
}  // namespace tactus
