// gRPC parses a header that is not complete from its start with each piece that
// comes, and keeps all headers of a block until the block ends. A value that
// claimed 4 GiB held up robots for 14 s, an HPACK number without end made the
// server end itself, and a flood of CONTINUATION frames took 1.3 GB. Frames
// that carry nothing held up robots for as long as they came.
#include <functional>
#include <string>

#include "gtest/gtest.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using testing::Bystander;
using testing::ChildTactusd;
using testing::RawHttp2;

constexpr uint8_t kContinuation = 9;
constexpr int kMiB = 1024 * 1024;
constexpr double kMostMibAfterFlood = 100;

// A call's headers, and the beginning of one more, whose value follows.
std::string Unfinished(std::string_view length_of_value) {
  return RawHttp2::Block("/tactus.v1.ContactService/ClassifyContact")
      .append(std::string("\0\1x", 3))
      .append(length_of_value);
}

struct Flood {
  const char* name;
  // Sends the first frames; the piece that is then sent again and again.
  std::function<std::string(RawHttp2&)> begin;
};

void PrintTo(const Flood& flood, std::ostream* out) { *out << flood.name; }

std::string Piece(uint8_t type, uint32_t stream, const std::string& payload) {
  return RawHttp2::FrameBytes(type, 0, stream, payload);
}

const Flood kFloods[] = {
    {"ValueOf4GiB",
     [](RawHttp2& http2) {
       http2.Frame(RawHttp2::kHeaders, 0, 1,
                   Unfinished("\x7f\x80\xff\xff\xff\x0f"));
       return Piece(kContinuation, 1, std::string(16384, 'a'));
     }},
    {"NumberWithoutEnd",
     [](RawHttp2& http2) {
       http2.Frame(RawHttp2::kHeaders, 0, 1, Unfinished("\x7f"));
       return Piece(kContinuation, 1, std::string(16384, '\x80'));
     }},
    {"SmallHeaders",
     [](RawHttp2& http2) {
       http2.Frame(RawHttp2::kHeaders, 0, 1, Unfinished("\1v"));
       std::string headers;
       for (int i = 0; i < 3000; ++i) headers += std::string("\0\1a\1b", 5);
       return Piece(kContinuation, 1, headers);
     }},
    {"EmptyContinuations",
     [](RawHttp2& http2) {
       http2.Frame(RawHttp2::kHeaders, 0, 1, Unfinished("\1v"));
       return Piece(kContinuation, 1, "");
     }},
    {"Pings", [](RawHttp2&) { return Piece(RawHttp2::kPing, 0, "12345678"); }},
    {"Settings", [](RawHttp2&) { return Piece(RawHttp2::kSettings, 0, ""); }},
    {"WindowUpdates",
     [](RawHttp2&) {
       return Piece(RawHttp2::kWindowUpdate, 0, std::string("\0\0\0\1", 4));
     }},
    {"FramesOfNoType", [](RawHttp2&) { return Piece(200, 1, "x"); }},
    {"EmptyMessages",
     [](RawHttp2& http2) {
       const uint32_t call =
           http2.Open("/tactus.v1.ContactService/ClassifyContact");
       return Piece(RawHttp2::kData, call, "");
     }},
};

class FloodTest : public ::testing::TestWithParam<Flood> {};

// 64 MiB at the most: a server that takes them all has not closed.
TEST_P(FloodTest, ItsConnectionEndsAndOthersGoOn) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  RawHttp2 stranger(server.port());
  const std::string piece = GetParam().begin(stranger);
  std::string pieces;
  while (pieces.size() < 64 * 1024) pieces += piece;
  for (size_t sent = 0; sent < 64 * kMiB && stranger.open();
       sent += pieces.size()) {
    stranger.Append(pieces);
    stranger.Flush();
  }
  EXPECT_FALSE(stranger.open());
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
  EXPECT_TRUE(server.PeakIsBelow(kMostMibAfterFlood));
  EXPECT_NE(server.Log().find("closed a connection from 127.0.0.1: "),
            std::string::npos)
      << server.Log();
}

INSTANTIATE_TEST_SUITE_P(All, FloodTest, ::testing::ValuesIn(kFloods),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace tactus::internal
