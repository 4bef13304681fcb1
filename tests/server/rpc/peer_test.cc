// Limits per peer count hosts, not connections.
#include "server/ops/peer.h"

#include "gtest/gtest.h"

namespace tactus::server {
namespace {

TEST(PeerTest, IsAHostOrANetwork) {
  EXPECT_EQ(PeerOf("ipv4:192.0.2.7:50123"), "192.0.2.7");
  EXPECT_EQ(PeerOf("ipv4:192.0.2.7:1"), PeerOf("ipv4:192.0.2.7:2"));
  EXPECT_NE(PeerOf("ipv4:192.0.2.7:1"), PeerOf("ipv4:192.0.2.8:1"));
  EXPECT_EQ(PeerOf("ipv6:%5B2001:db8::1%5D:50123"), "2001:db8:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:[2001:db8::ffff:2]:1"), "2001:db8:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:%5Bfe80::1%25eth0%5D:1"), "fe80:0:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:%5B::ffff:192.0.2.7%5D:1"), "::ffff:192.0.2.7");
  EXPECT_EQ(PeerOf("unix:/run/a"), "unix");
  EXPECT_EQ(PeerOf("unix:"), "unix");
  EXPECT_EQ(PeerOf("inproc"), "inproc");
  // Whatever gRPC may come to write is some peer, and no crash.
  for (const char* text : {"", "ipv4:", "ipv6:", "ipv6:[", "ipv6:]", "x"}) {
    PeerOf(text);
  }
}

}  // namespace
}  // namespace tactus::server
