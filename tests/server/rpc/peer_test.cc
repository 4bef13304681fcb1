// Limits per peer count hosts, not connections.
#include "server/ops/peer.h"

#include <arpa/inet.h>

#include <cstring>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "server/listen/socket_address.h"

namespace tactus::internal::server {
namespace {

TEST(PeerTest, IsAHostOrANetwork) {
  EXPECT_EQ(PeerOf("ipv4:192.0.2.7:50123"), "192.0.2.7");
  EXPECT_EQ(PeerOf("ipv4:192.0.2.7:1"), PeerOf("ipv4:192.0.2.7:2"));
  EXPECT_NE(PeerOf("ipv4:192.0.2.7:1"), PeerOf("ipv4:192.0.2.8:1"));
  EXPECT_EQ(PeerOf("ipv6:%5B2001:db8::1%5D:50123"), "2001:db8:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:[2001:db8::ffff:2]:1"), "2001:db8:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:%5Bfe80::1%25eth0%5D:1"), "fe80:0:0:0::/64");
  EXPECT_EQ(PeerOf("ipv6:%5B::ffff:192.0.2.7%5D:1"), "192.0.2.7");
  EXPECT_EQ(PeerOf("unix:/run/a"), "unix");
  EXPECT_EQ(PeerOf("unix:"), "unix");
  EXPECT_EQ(PeerOf("inproc"), "inproc");
  // Any other text is some peer, and nothing crashes.
  for (const char* text :
       {"", "ipv4:", "ipv6:", "ipv6:[", "ipv6:]", "ipv6:[]", "x"}) {
    PeerOf(text);
  }
}

TEST(PeerTest, OnlyLoopbackAndUnixSocketsAreOnThisHost) {
  for (const char* peer :
       {"inproc", "unix:", "unix:/run/tactusd.sock", "unix-abstract:x",
        "ipv4:127.0.0.1:50123", "ipv4:127.255.3.4:1", "ipv6:%5B::1%5D:50123",
        "ipv6:[::1]:1", "ipv6:%5B::ffff:127.0.0.1%5D:1",
        "ipv6:[::ffff:127.9.9.9]:1"}) {
    EXPECT_TRUE(IsOnThisHost(peer)) << peer;
  }
  for (const char* peer : {"",
                           "x",
                           "unknown",
                           "unix",
                           "unixbox:1",
                           "inproc2",
                           "127.0.0.1:1",
                           "ipv4:",
                           "ipv4:128.0.0.1:1",
                           "ipv4:192.0.2.7:127",
                           "ipv4:10.127.0.1:1",
                           "ipv4:127.0.0.1.example:1",
                           "ipv4:localhost:1",
                           "ipv6:",
                           "ipv6:::1",
                           "ipv6:[::1]",
                           "ipv6:[::1",
                           "ipv6:[::2]:1",
                           "ipv6:[::127.0.0.1]:1",
                           "ipv6:[::ffff:192.0.2.7]:1",
                           "ipv6:%5B2001:db8::1%5D:1",
                           "ipv6:[fe80::1%25lo]:1",
                           "ipv6:[1::ffff:127.0.0.1]:1"}) {
    EXPECT_FALSE(IsOnThisHost(peer)) << peer;
  }
}

sockaddr_storage Storage(const char* host) {
  sockaddr_storage storage = {};
  sockaddr_in ipv4 = {};
  sockaddr_in6 ipv6 = {};
  if (inet_pton(AF_INET, host, &ipv4.sin_addr) == 1) {
    ipv4.sin_family = AF_INET;
    std::memcpy(&storage, &ipv4, sizeof(ipv4));
  } else if (inet_pton(AF_INET6, host, &ipv6.sin6_addr) == 1) {
    ipv6.sin6_family = AF_INET6;
    std::memcpy(&storage, &ipv6, sizeof(ipv6));
  }
  return storage;
}

// The limit on connections and the limit on streams count by the same name.
TEST(PeerTest, AConnectionHasThePeerOfItsCalls) {
  const std::pair<const char*, const char*> hosts[] = {
      {"192.0.2.7", "ipv4:192.0.2.7:50123"},
      {"2001:db8:1:2:3:4:5:6", "ipv6:%5B2001:db8:1:2::9%5D:50123"},
      {"::ffff:192.0.2.7", "ipv4:192.0.2.7:50123"},
      {"::1", "ipv6:%5B::1%5D:50123"}};
  for (const auto& [host, address] : hosts) {
    const SocketAddress socket = {.storage = Storage(host)};
    EXPECT_EQ(PeerOfHost(socket.HostText()), PeerOf(address)) << host;
  }
}

}  // namespace
}  // namespace tactus::internal::server
