// A server that sent headers without end made trainctl wait for a minute, or
// take more than a gigabyte; one that announced its end on each new connection
// made it connect again and again, for as long as a call may take.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "gtest/gtest.h"
#include "tests/support/raw_http2.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::client {
namespace {

using ::tactus::internal::testing::RawHttp2;
using testing::Outcome;
using testing::Trainctl;

constexpr uint8_t kContinuation = 9;
constexpr int kMostPieces = 4'000;

// Speaks to each client in turn: its settings, `first`, and then `piece` again
// and again until the client leaves.
class HostileServer {
 public:
  HostileServer(std::string first, std::string piece)
      : first_(std::move(first)), piece_(std::move(piece)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    bind(listener_, generic, size);
    listen(listener_, 64);
    getsockname(listener_, generic, &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Run(); });
  }
  ~HostileServer() {
    stopping_ = true;
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }

  std::string flag() const {
    return "--server=127.0.0.1:" + std::to_string(port_);
  }
  int connections() const { return connections_; }

 private:
  void Run() {
    while (!stopping_) {
      const int client = accept(listener_, nullptr, nullptr);
      if (client < 0) continue;
      ++connections_;
      Send(client, RawHttp2::FrameBytes(RawHttp2::kSettings, 0, 0, ""));
      // The client's preface; then its call, or the timeout.
      char bytes[4096];
      pollfd readable = {client, POLLIN, 0};
      for (int i = 0; i < 3 && poll(&readable, 1, 100) > 0; ++i) {
        if (recv(client, bytes, sizeof(bytes), 0) <= 0) break;
      }
      bool open = Send(client, first_);
      for (int i = 0; open && i < kMostPieces; ++i) open = Send(client, piece_);
      close(client);
    }
  }
  static bool Send(int client, const std::string& bytes) {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t count =
          send(client, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return false;
      sent += static_cast<size_t>(count);
    }
    return true;
  }

  const std::string first_;
  const std::string piece_;
  const int listener_ = socket(AF_INET, SOCK_STREAM, 0);
  int port_ = 0;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> connections_ = 0;
  std::thread thread_;
};

// ":status: 200", which is in HPACK's table.
constexpr char kStatus200[] = "\x88";

TEST(HostileServerTest, AValueOf4GiB) {
  const HostileServer server(
      RawHttp2::FrameBytes(RawHttp2::kHeaders, 0, 1,
                           std::string(kStatus200) +
                               std::string("\0\1x\x7f\x80\xff\xff\xff\x0f", 9)),
      RawHttp2::FrameBytes(kContinuation, 0, 1, std::string(16384, 'a')));
  const Outcome outcome = Trainctl({"datasets", "list", server.flag()});
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
  const Outcome outcome = Trainctl({"datasets", "list", server.flag()});
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
  const Outcome outcome = Trainctl({"datasets", "list", server.flag()});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_LT(server.connections(), 20);
}

}  // namespace
}  // namespace tactus::internal::client
