#include "core/base/address.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(AddressTest, OnlyTheUnixPrefixMakesAUnixSocket) {
  EXPECT_TRUE(IsUnixAddress("unix:/run/tactusd.sock"));
  EXPECT_TRUE(IsUnixAddress("unix:relative"));
  for (const char* host : {"unixbox:50051", "unix", "unix-abstract:x",
                           "UNIX:/x", "127.0.0.1:1", ""}) {
    EXPECT_FALSE(IsUnixAddress(host)) << host;
  }
  EXPECT_EQ(UnixPath("unix:/run/a"), "/run/a");
  EXPECT_EQ(UnixPath("unix:///run/a"), "/run/a");
  EXPECT_EQ(UnixPath("unix:a"), "a");
}

TEST(AddressTest, HostAndPortComeApart) {
  const auto v6 = ParseHostPort("[2001:db8::1]:50051");
  ASSERT_TRUE(v6.ok()) << v6.status();
  EXPECT_EQ(v6->host, "2001:db8::1");
  EXPECT_EQ(v6->port, 50051);
  const auto name = ParseHostPort("unixbox:0");
  ASSERT_TRUE(name.ok()) << name.status();
  EXPECT_EQ(name->host, "unixbox");
  EXPECT_EQ(name->port, 0);
}

TEST(AddressTest, LoopbackAndUnixSocketsStayOnThisHost) {
  for (const char* address : {"unix:/run/a", "localhost:1", "127.0.0.1:50051",
                              "127.1.2.3:1", "[::1]:50051"}) {
    EXPECT_TRUE(StaysOnThisHost(address)) << address;
  }
  for (const char* address :
       {"", "127.0.0.1", "127.example.org:1", "localhost.example:1",
        "0.0.0.0:1", "[::]:1", "192.0.2.7:1", "[2001:db8::1]:1"}) {
    EXPECT_FALSE(StaysOnThisHost(address)) << address;
  }
}

TEST(AddressTest, OtherTextIsRefused) {
  for (const char* text :
       {"", "host", ":50051", "host:", "host:x", "host:65536", "host:-1",
        "::1:50051", "[]:1", "2001:db8::1"}) {
    EXPECT_EQ(ReasonOf(ParseHostPort(text).status()), "INVALID_CONFIG") << text;
  }
}

}  // namespace
}  // namespace tactus::internal
