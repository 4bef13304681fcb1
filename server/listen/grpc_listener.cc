#include "server/listen/grpc_listener.h"

#include <unistd.h>

#include <utility>

#include "core/base/status_macros.h"
#include "core/connections/vetted_connections.h"
#include "grpcpp/security/server_credentials.h"
#include "server/ops/clock.h"
#include "server/ops/log_limiter.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

// Strangers cause faults, so their lines are bounded.
void LogFault(int fd, absl::string_view fault) {
  static LogLimiter limiter({.lines_per_second = 1, .burst = 5});
  const auto left_out = limiter.Admit(MonotonicNs());
  if (!left_out) return;
  spdlog::warn("closed a connection from {}: {}{}",
               fd < 0 ? "a TLS peer" : SocketAddress::OfPeer(fd).HostText(),
               std::string(fault), LeftOut(*left_out));
}

}  // namespace

absl::StatusOr<std::unique_ptr<GrpcListener>> GrpcListener::Open(
    const Options& options) {
  VettedConnections::Start(
      {.accepts = true, .now_ns = MonotonicNs, .on_fault = LogFault});
  std::unique_ptr<GrpcListener> listener(new GrpcListener(options));
  std::vector<ListeningSocket> sockets;
  for (const std::string& address : options.addresses) {
    TACTUS_ASSIGN_OR_RETURN(auto opened, ListenOn(address));
    listener->ports_.push_back(opened.front().bound.port());
    for (ListeningSocket& socket : opened) sockets.push_back(std::move(socket));
  }
  listener->acceptor_ = std::make_unique<Acceptor>(
      std::move(sockets), options.limits,
      [raw = listener.get()](const ListeningSocket& socket, int fd) {
        raw->HandOver(socket, fd);
      });
  return listener;
}

void GrpcListener::AddTo(grpc::ServerBuilder& builder) {
  using ConnectionType =
      grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS,
                             options_.handshake_timeout_ms);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS,
                             options_.connection_idle_ms);
  for (const ListeningSocket& socket : acceptor_->sockets()) {
    if (UsesTls(socket) && tls_ == nullptr) {
      tls_ = builder.experimental().AddExternalConnectionAcceptor(
          ConnectionType::FROM_FD,
          Guard(TlsCredentials(*options_.tls), options_.guards));
    } else if (!UsesTls(socket) && plain_ == nullptr) {
      plain_ = builder.experimental().AddExternalConnectionAcceptor(
          ConnectionType::FROM_FD,
          Guard(grpc::InsecureServerCredentials(), options_.guards));
    }
  }
}

void GrpcListener::HandOver(const ListeningSocket& socket, int fd) {
  if (!UsesTls(socket) && !VettedConnections::Add(fd)) {
    close(fd);
    return;
  }
  GrpcAcceptor::NewConnectionParameters connection;
  connection.listener_fd = socket.fd.get();
  connection.fd = fd;
  (UsesTls(socket) ? tls_ : plain_)->HandleNewConnection(&connection);
}

}  // namespace tactus::internal::server
