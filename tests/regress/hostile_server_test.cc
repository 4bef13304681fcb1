// A server that sent headers without end made trainctl wait for a minute, or
// take more than a gigabyte; one that announced its end on each new connection
// made it connect again and again, for as long as a call may take.
#include "tests/support/hostile_server.h"

#include <string>

#include "gtest/gtest.h"
#include "tests/support/raw_http2.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::client {
namespace {

using ::tactus::internal::testing::HostileServer;
using ::tactus::internal::testing::RawHttp2;
using testing::Outcome;
using testing::Trainctl;

constexpr uint8_t kContinuation = 9;

std::string Flag(const HostileServer& server) {
  return "--server=" + server.address();
}

// ":status: 200", which is in HPACK's table.
constexpr char kStatus200[] = "\x88";

TEST(HostileServerTest, AValueOf4GiB) {
  const HostileServer server(
      RawHttp2::FrameBytes(RawHttp2::kHeaders, 0, 1,
                           std::string(kStatus200) +
                               std::string("\0\1x\x7f\x80\xff\xff\xff\x0f", 9)),
      RawHttp2::FrameBytes(kContinuation, 0, 1, std::string(16384, 'a')));
  const Outcome outcome = Trainctl({"datasets", "list", Flag(server)});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_NE(outcome.err.find("the server closed the connection"),
            std::string::npos)
      << outcome.err;
}

TEST(HostileServerTest, HeadersWithoutEnd) {
  std::string headers;
  for (int i = 0; i < 3'000; ++i) headers += std::string("\0\1a\1b", 5);
  const HostileServer server(
      RawHttp2::FrameBytes(RawHttp2::kHeaders, 0, 1, kStatus200),
      RawHttp2::FrameBytes(kContinuation, 0, 1, headers));
  const Outcome outcome = Trainctl({"datasets", "list", Flag(server)});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_NE(outcome.err.find("the server closed the connection"),
            std::string::npos)
      << outcome.err;
}

TEST(HostileServerTest, AnEndOnEachConnection) {
  const HostileServer server(
      RawHttp2::FrameBytes(RawHttp2::kGoAway, 0, 0,
                           std::string("\x7f\xff\xff\xff\0\0\0\0", 8)),
      RawHttp2::FrameBytes(RawHttp2::kPing, 0, 0, "12345678"));
  const Outcome outcome = Trainctl({"datasets", "list", Flag(server)});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_LT(server.connections(), 20);
}

}  // namespace
}  // namespace tactus::internal::client
