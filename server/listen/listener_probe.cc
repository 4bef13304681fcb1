#include "server/listen/listener_probe.h"

#include <openssl/ssl.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <span>

#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/connections/vetted_connections.h"

namespace tactus::internal::server {
namespace {

// The connection preface and an empty SETTINGS frame (RFC 9113, 3.4).
constexpr absl::string_view kHello(
    "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);
// The header of an HTTP/2 frame: its length in three bytes, its type, flags.
constexpr size_t kHeaderBytes = 9;
constexpr uint8_t kSettingsType = 4;
constexpr uint8_t kAckFlag = 1;
// Frames before the acknowledgement, and the bytes of one.
constexpr int kMostFrames = 16;
constexpr size_t kMostFrameBytes = 1024;

// Works as read(2) and write(2) do.
struct Transport {
  std::function<int(uint8_t* to, size_t bytes)> read;
  std::function<int(const char* from, size_t bytes)> write;
};

absl::Status Failed(const char* step) {
  // Blocking sockets with a timeout report it as EAGAIN.
  const bool timed_out = errno == EAGAIN || errno == EINPROGRESS;
  return IoError(step, timed_out ? "no answer in time" : std::strerror(errno));
}

absl::Status ReadAll(const Transport& transport, std::span<uint8_t> to) {
  while (!to.empty()) {
    const int bytes = transport.read(to.data(), to.size());
    if (bytes == 0) return IoError("read", "the server closed the connection");
    if (bytes < 0) return Failed("read");
    to = to.subspan(static_cast<size_t>(bytes));
  }
  return absl::OkStatus();
}

// Sends settings and waits until the server acknowledges them.
absl::Status ExpectHttp2(const Transport& transport) {
  if (transport.write(kHello.data(), kHello.size()) !=
      static_cast<int>(kHello.size())) {
    return Failed("write");
  }
  std::array<uint8_t, kHeaderBytes> header = {};
  std::array<uint8_t, kMostFrameBytes> payload = {};
  for (int i = 0; i < kMostFrames; ++i) {
    TACTUS_RETURN_IF_ERROR(ReadAll(transport, header));
    const size_t size = header[0] << 16 | header[1] << 8 | header[2];
    if (size > payload.size()) break;
    TACTUS_RETURN_IF_ERROR(
        ReadAll(transport, std::span<uint8_t>(payload).first(size)));
    if (header[3] == kSettingsType && (header[4] & kAckFlag) != 0) {
      return absl::OkStatus();
    }
  }
  return IoError("read", "the answer is not HTTP/2");
}

std::shared_ptr<SSL_CTX> MakeTls() {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_client_method()),
                                   SSL_CTX_free);
  constexpr std::array<unsigned char, 3> kHttp2 = {2, 'h', '2'};
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_NONE, nullptr);
  SSL_CTX_set_alpn_protos(context.get(), kHttp2.data(), kHttp2.size());
  return context;
}

absl::Status ExpectHttp2OverTls(SSL_CTX* context, int fd) {
  const std::unique_ptr<SSL, decltype(&SSL_free)> tls(SSL_new(context),
                                                      SSL_free);
  SSL_set_fd(tls.get(), fd);
  if (SSL_connect(tls.get()) != 1) return Failed("TLS handshake");
  return ExpectHttp2(
      {.read =
           [&](uint8_t* to, size_t bytes) {
             return SSL_read(tls.get(), to, static_cast<int>(bytes));
           },
       .write =
           [&](const char* from, size_t bytes) {
             return SSL_write(tls.get(), from, static_cast<int>(bytes));
           }});
}

absl::Status ExpectHttp2OverTcp(int fd) {
  return ExpectHttp2({.read =
                          [fd](uint8_t* to, size_t bytes) {
                            return static_cast<int>(recv(fd, to, bytes, 0));
                          },
                      .write =
                          [fd](const char* from, size_t bytes) {
                            return static_cast<int>(
                                send(fd, from, bytes, MSG_NOSIGNAL));
                          }});
}

}  // namespace

ListenerProbe::ListenerProbe(Acceptor* acceptor, const SocketAddress& bound,
                             bool tls)
    : acceptor_(acceptor), target_(bound.Reachable()) {
  if (tls) tls_ = MakeTls();
}

absl::Status ListenerProbe::Run(std::chrono::milliseconds timeout) {
  const FileDescriptor fd(
      socket(target_.family(), SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return Failed("socket");
  const timeval limit = {timeout.count() / 1000, timeout.count() % 1000 * 1000};
  setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
  setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
  // Bound before it connects, so that the acceptor knows whom to expect: on a
  // free port of the address that it connects to, or, as a unix socket, under
  // a name that the kernel chooses.
  SocketAddress own = target_;
  own.set_port(0);
  if (own.is_unix()) own.length = sizeof(sa_family_t);
  if (bind(fd.get(), own.get(), own.length) != 0) return Failed("bind");
  acceptor_->ExpectSelfCheck(SocketAddress::OfSocket(fd.get()));
  if (connect(fd.get(), target_.get(), target_.length) != 0) {
    return Failed("connect");
  }
  TACTUS_RETURN_IF_ERROR(tls_ != nullptr
                             ? ExpectHttp2OverTls(tls_.get(), fd.get())
                             : ExpectHttp2OverTcp(fd.get()));
  // The server has read the probe's bytes, so the vet has seen them.
  if (VettedConnections::bytes() == 0) {
    return IoError("read", "gRPC reads bytes that no vet has seen");
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
