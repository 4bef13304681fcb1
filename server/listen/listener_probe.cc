#include "server/listen/listener_probe.h"

#include <openssl/ssl.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <functional>

#include "core/base/errors.h"

namespace tactus::server {
namespace {

// The header of an HTTP/2 frame, whose fourth byte is its type (RFC 9113).
constexpr size_t kHeaderBytes = 9;
constexpr uint8_t kSettingsType = 4;

absl::Status Failed(const char* step) {
  // Blocking sockets with a timeout report it as EAGAIN.
  const bool timed_out = errno == EAGAIN || errno == EINPROGRESS;
  return IoError(step, timed_out ? "no answer in time" : std::strerror(errno));
}

// Reads a frame's header with `read`, which works as read(2) does.
absl::Status ExpectSettings(
    const std::function<int(uint8_t* to, size_t bytes)>& read) {
  std::array<uint8_t, kHeaderBytes> header = {};
  size_t got = 0;
  while (got < header.size()) {
    const int bytes = read(header.data() + got, header.size() - got);
    if (bytes == 0) return IoError("read", "the server closed the connection");
    if (bytes < 0) return Failed("read");
    got += static_cast<size_t>(bytes);
  }
  if (header[3] != kSettingsType) {
    return IoError("read", "the answer is not HTTP/2");
  }
  return absl::OkStatus();
}

std::shared_ptr<SSL_CTX> MakeTls() {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_client_method()),
                                   SSL_CTX_free);
  constexpr std::array<unsigned char, 3> kHttp2 = {2, 'h', '2'};
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_NONE, nullptr);
  SSL_CTX_set_alpn_protos(context.get(), kHttp2.data(), kHttp2.size());
  return context;
}

absl::Status ExpectSettingsOverTls(SSL_CTX* context, int fd) {
  const std::unique_ptr<SSL, decltype(&SSL_free)> tls(SSL_new(context),
                                                      SSL_free);
  SSL_set_fd(tls.get(), fd);
  if (SSL_connect(tls.get()) != 1) return Failed("TLS handshake");
  return ExpectSettings([&](uint8_t* to, size_t bytes) {
    return SSL_read(tls.get(), to, static_cast<int>(bytes));
  });
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
  if (tls_ != nullptr) return ExpectSettingsOverTls(tls_.get(), fd.get());
  return ExpectSettings([&](uint8_t* to, size_t bytes) {
    return static_cast<int>(recv(fd.get(), to, bytes, 0));
  });
}

}  // namespace tactus::server
