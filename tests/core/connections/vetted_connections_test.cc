#include "core/connections/vetted_connections.h"

#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "absl/base/config.h"
#include "absl/strings/string_view.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kHello(
    "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);

int faults = 0;
std::string last_fault;

void CountFault(int, absl::string_view fault) {
  ++faults;
  last_fault = std::string(fault);
}

class VettedConnectionsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends_), 0);
#ifdef ABSL_HAVE_THREAD_SANITIZER
    GTEST_SKIP() << "ThreadSanitizer replaces recvmsg itself";
#endif
    VettedConnections::Start({.accepts = true,
                              .now_ns = [] { return int64_t{1}; },
                              .on_fault = CountFault});
    faults = 0;
  }
  void TearDown() override {
    for (const int end : ends_) close(end);
  }

  void Send(absl::string_view bytes) {
    ASSERT_EQ(send(ends_[1], bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  // As gRPC reads: into several pieces of memory.
  std::string Receive() {
    std::string first(10, '\0');
    std::string second(1000, '\0');
    iovec parts[] = {{first.data(), first.size()},
                     {second.data(), second.size()}};
    msghdr message = {};
    message.msg_iov = parts;
    message.msg_iovlen = 2;
    const ssize_t size = recvmsg(ends_[0], &message, 0);
    if (size <= 0) return size == 0 ? "end" : "error";
    first += second;
    first.resize(static_cast<size_t>(size));
    return first;
  }

  int ends_[2] = {-1, -1};
};

TEST_F(VettedConnectionsTest, GoodBytesArriveAsTheyAre) {
  ASSERT_TRUE(VettedConnections::Add(ends_[0]));
  const uint64_t before = VettedConnections::bytes();
  Send(kHello);
  EXPECT_EQ(Receive(), kHello);
  EXPECT_EQ(VettedConnections::bytes(), before + kHello.size());
  EXPECT_EQ(faults, 0);
}

TEST_F(VettedConnectionsTest, AFaultEndsTheConnectionOnce) {
  ASSERT_TRUE(VettedConnections::Add(ends_[0]));
  Send("GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(Receive(), "end");
  EXPECT_EQ(Receive(), "end");
  EXPECT_EQ(faults, 1);
  EXPECT_EQ(last_fault, "it does not speak HTTP/2");
  // The peer sees the end too.
  EXPECT_LT(send(ends_[1], "x", 1, MSG_NOSIGNAL), 0);
}

TEST_F(VettedConnectionsTest, AClosedDescriptorIsForgotten) {
  ASSERT_TRUE(VettedConnections::Add(ends_[0]));
  const int number = ends_[0];
  TearDown();
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends_), 0);
  ASSERT_EQ(ends_[0], number);
  Send("GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(Receive(), "GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(faults, 0);
}

TEST_F(VettedConnectionsTest, OthersAreNotLookedAt) {
  Send("anything");
  EXPECT_EQ(Receive(), "anything");
  EXPECT_EQ(faults, 0);
}

TEST_F(VettedConnectionsTest, ADescriptorWithoutAPlaceIsRefused) {
  EXPECT_FALSE(VettedConnections::Add(-1));
  EXPECT_FALSE(VettedConnections::Add(1 << 30));
}

}  // namespace
}  // namespace tactus::internal
