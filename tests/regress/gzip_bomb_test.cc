// One message of 600 kB, marked as gzip, inflated to 600 MB before any check of
// its size: the server's memory peaked at 680 MB, above the limit of the unit
// and of the image.
#include <zlib.h>

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

constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyContact";
constexpr double kMostMib = 100;

// `mib` MiB of zeros as gRPC's encoding "gzip" or "deflate": a thousandth of
// that size.
std::string Bomb(const std::string& encoding, int mib) {
  std::string zeros(1 << 20, '\0');
  std::string block(1 << 16, '\0');
  std::string bomb;
  z_stream stream = {};
  // A window of 15 bits; 16 more ask for gzip's header instead of zlib's.
  const int window = encoding == "gzip" ? 15 | 16 : 15;
  deflateInit2(&stream, 9, Z_DEFLATED, window, 9, Z_DEFAULT_STRATEGY);
  for (int i = 1; i <= mib; ++i) {
    stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
    stream.avail_in = static_cast<uInt>(zeros.size());
    do {
      stream.next_out = reinterpret_cast<Bytef*>(block.data());
      stream.avail_out = static_cast<uInt>(block.size());
      deflate(&stream, i == mib ? Z_FINISH : Z_NO_FLUSH);
      bomb.append(block, 0, block.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
  return bomb;
}

// Sends `message` as a compressed one; true if the server ended the call.
bool IsRefused(const ChildTactusd& server, const std::string& encoding,
               const std::string& message) {
  RawHttp2 attacker(server.port());
  const uint32_t stream = attacker.Open(kMethod, {{"grpc-encoding", encoding}});
  // Flow control stops it where the server takes no more.
  attacker.Message(stream, message, true, milliseconds(500));
  return attacker.ReadUntil(
      [&] {
        return attacker.received(RawHttp2::kHeaders) +
                   attacker.received(RawHttp2::kReset) >
               0;
      },
      milliseconds(10'000));
}

class GzipBombTest : public ::testing::TestWithParam<const char*> {};

// 600 MiB in one message above the limit, and 100 MiB in one below it.
TEST_P(GzipBombTest, IsNeverInflated) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  const double before = server.ResidentMib();
  for (const int mib : {600, 100}) {
    EXPECT_TRUE(IsRefused(server, GetParam(), Bomb(GetParam(), mib)))
        << mib << " MiB";
    EXPECT_TRUE(robot.IsServed());
  }
  EXPECT_TRUE(server.PeakIsBelow(kMostMib));
  EXPECT_TRUE(server.ResidentIsBelow(before + 10));
  testing::ExpectGoodStream(Bystander::OwnConnection(server.address()),
                            testing::kModelWithoutPoses);
  EXPECT_TRUE(robot.Finish().ok());
}

INSTANTIATE_TEST_SUITE_P(Encodings, GzipBombTest,
                         ::testing::Values("gzip", "deflate"));

}  // namespace
}  // namespace tactus::internal
