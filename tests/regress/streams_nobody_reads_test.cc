// A peer that opened streams on a unix socket and read no answer kept them for
// good: gRPC's keepalive waits until the bytes before its ping are out. The
// server then did not end on SIGTERM within a minute.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <string>

#include "gtest/gtest.h"
#include "server/listen/connection_table.h"
#include "server/listen/file_descriptor.h"
#include "tests/server/support/test_server.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using server::ConnectionTable;
using server::FileDescriptor;
using testing::ChildTactusd;
using testing::RawHttp2;

constexpr int64_t kSecond = 1'000'000'000;

// A connection whose one end has written until the kernel takes no more.
struct FullPair {
  FileDescriptor writer;
  FileDescriptor reader;

  FullPair() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    writer = FileDescriptor(ends[0]);
    reader = FileDescriptor(ends[1]);
    const std::string bytes(4096, 'x');
    while (send(writer.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0) {
    }
  }
  bool is_open() const {
    return send(writer.get(), "x", 1, MSG_NOSIGNAL) > 0 || errno == EAGAIN;
  }
};

TEST(StreamsNobodyReadsTest, AConnectionWhosePeerReadsNothingEnds) {
  const FullPair pair;
  ConnectionTable table({.connections = 10, .per_peer = 10});
  table.Admit(pair.writer.get(), "");
  EXPECT_EQ(table.ShutDownUnread(1 * kSecond, 60 * kSecond), 0);
  EXPECT_EQ(table.ShutDownUnread(60 * kSecond, 60 * kSecond), 0);
  EXPECT_TRUE(pair.is_open());
  EXPECT_EQ(table.ShutDownUnread(61 * kSecond, 60 * kSecond), 1);
  EXPECT_FALSE(pair.is_open());
}

TEST(StreamsNobodyReadsTest, ASlowReaderStays) {
  const FullPair pair;
  ConnectionTable table({.connections = 10, .per_peer = 10});
  table.Admit(pair.writer.get(), "");
  std::array<char, 4096> buffer;
  for (int i = 1; i < 20; ++i) {
    EXPECT_EQ(table.ShutDownUnread(i * 50 * kSecond, 60 * kSecond), 0);
    ASSERT_GT(recv(pair.reader.get(), buffer.data(), buffer.size(), 0), 0);
  }
  // Nothing waits: silence is no fault.
  while (recv(pair.reader.get(), buffer.data(), buffer.size(), 0) > 0) {
  }
  EXPECT_EQ(table.ShutDownUnread(2'000 * kSecond, 60 * kSecond), 0);
  EXPECT_EQ(table.ShutDownUnread(3'000 * kSecond, 60 * kSecond), 0);
}

// The server cannot write to it, and ends all the same.
TEST(StreamsNobodyReadsTest, TheServerEnds) {
  const std::string path =
      "/tmp/tactus-unread-" + std::to_string(getpid()) + ".sock";
  ChildTactusd server({"--listen=unix:" + path, "--drain-grace-ms=200"});
  ASSERT_NE(server.port(), 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  const FileDescriptor stranger(socket(AF_UNIX, SOCK_STREAM, 0));
  ASSERT_EQ(connect(stranger.get(), reinterpret_cast<sockaddr*>(&address),
                    sizeof(address)),
            0);
  std::string bytes = std::string(RawHttp2::kPreface) +
                      RawHttp2::FrameBytes(RawHttp2::kSettings, 0, 0, "");
  for (uint32_t stream = 1; stream < 2'000; stream += 2) {
    bytes += RawHttp2::FrameBytes(
        RawHttp2::kHeaders, RawHttp2::kEndHeaders, stream,
        RawHttp2::Block("/tactus.v1.ContactService/ClassifyContact"));
    // A message without a field: an error, which nobody reads.
    bytes += RawHttp2::FrameBytes(RawHttp2::kData, 0, stream,
                                  std::string("\0\0\0\0\0", 5));
  }
  ASSERT_EQ(send(stranger.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(bytes.size()));
  // gRPC has taken the first streams when it can write no more.
  ASSERT_TRUE(testing::Eventually(
      [&] { return server.Log().find("stream 100 ") != std::string::npos; }));
  server.Signal(SIGTERM);
  EXPECT_EQ(server.WaitFor(std::chrono::seconds(20)), 0);
  unlink(path.c_str());
}

}  // namespace
}  // namespace tactus::internal
