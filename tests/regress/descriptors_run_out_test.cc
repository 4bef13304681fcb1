// With 128 file descriptors and 200 idle connections, gRPC 1.51 failed to
// accept once and never accepted again, even after all connections had closed.
// The process looked alive.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <memory>
#include <vector>

#include "gtest/gtest.h"
#include "server/listen/file_descriptor.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"

namespace tactus::internal {
namespace {

using server::FileDescriptor;
using testing::Bystander;
using testing::ChildTactusd;
using testing::Eventually;

// A connection from `from` that sends nothing.
FileDescriptor ConnectTo(int port, const char* from = "127.0.0.1") {
  FileDescriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in own = {};
  own.sin_family = AF_INET;
  inet_pton(AF_INET, from, &own.sin_addr);
  bind(fd.get(), reinterpret_cast<sockaddr*>(&own), sizeof(own));
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  connect(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address));
  return fd;
}

// True if the server has closed the connection; takes what it has sent.
bool IsClosed(const FileDescriptor& fd) {
  char bytes[256];
  ssize_t got = 0;
  while ((got = recv(fd.get(), bytes, sizeof(bytes), MSG_DONTWAIT)) > 0) {
  }
  return got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
}

int CountClosed(const std::vector<FileDescriptor>& connections) {
  int closed = 0;
  for (const FileDescriptor& fd : connections) closed += IsClosed(fd);
  return closed;
}

TEST(DescriptorsRunOutTest, ServerAcceptsAgainAfterIdleConnections) {
  ChildTactusd server(ChildTactusd::Options{.max_open_files = 128});
  ASSERT_NE(server.port(), 0) << server.Log();
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  {
    std::vector<FileDescriptor> idle;
    for (int i = 0; i < 200; ++i) idle.push_back(ConnectTo(server.port()));
    // 64 connections fit, half of them for one peer.
    EXPECT_TRUE(Eventually([&] { return CountClosed(idle) >= 200 - 32; }));
    EXPECT_TRUE(robot.IsServed());
    // The server still accepts another peer.
    const FileDescriptor other = ConnectTo(server.port(), "127.0.0.2");
    char byte = 0;
    EXPECT_EQ(recv(other.get(), &byte, 1, 0), 1);
  }
  EXPECT_TRUE(Eventually([&] {
    Bystander late(server.address());
    return late.IsServed(1);
  })) << server.Log();
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
}

TEST(DescriptorsRunOutTest, ServerThatCannotAcceptEnds) {
  ChildTactusd server(ChildTactusd::Options{.flags = {"--self-check-ms=500"}});
  ASSERT_NE(server.port(), 0) << server.Log();
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  // No further descriptor from now on.
  const rlimit none = {1, 1};
  ASSERT_EQ(prlimit(server.pid(), RLIMIT_NOFILE, &none, nullptr), 0);
  EXPECT_EQ(server.WaitFor(std::chrono::seconds(30)), 1);
  EXPECT_NE(server.Log().find("has not answered"), std::string::npos)
      << server.Log();
}

TEST(DescriptorsRunOutTest, UnfinishedHandshakesAndIdleConnectionsAreClosed) {
  server::TactusServer::Options options;
  options.listen = {"127.0.0.1:0"};
  options.handshake_timeout_ms = 200;
  options.connection_idle_ms = 1'000;
  testing::TestServer server(options);
  const int port = server.server().ports()[0];
  Bystander robot("127.0.0.1:" + std::to_string(port), /*model=*/"");
  std::vector<FileDescriptor> idle;
  for (int i = 0; i < 10; ++i) idle.push_back(ConnectTo(port));
  EXPECT_TRUE(Eventually([&] { return CountClosed(idle) == 10; }));
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
}

}  // namespace
}  // namespace tactus::internal
