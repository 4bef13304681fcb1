// File: grpc_listener.h
//
// GrpcListener: the addresses of a gRPC server, with limits on connections that
// gRPC does not have. It opens and accepts the sockets itself and hands each
// connection to gRPC, which does the TLS handshake and all that follows.
//
//   TACTUS_ASSIGN_OR_RETURN(auto listener, GrpcListener::Open(options));
//   listener->AddTo(builder);
//   server = builder.BuildAndStart();
//   listener->Start();
//   // ... until the process is to end ...
//   listener->Stop();        // before server->Shutdown()
//
// Thread-safety: as Acceptor.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "grpcpp/server_builder.h"
#include "server/listen/acceptor.h"
#include "server/ops/guarded_credentials.h"
#include "server/ops/tls.h"

namespace tactus::internal::server {

class GrpcListener {
 public:
  struct Options {
    // "host:port" or "unix:path"; may be empty.
    std::vector<std::string> addresses;
    // TLS on every host:port. Unix sockets are always plain: the permissions
    // of their file guard them.
    std::optional<TlsIdentity> tls;
    // Bound the calls on all addresses.
    Guards guards;
    ConnectionTable::Limits limits;
    int handshake_timeout_ms = 0;
    // Closes a connection that has had no call for this long.
    int connection_idle_ms = 0;
  };

  // Opens all sockets. INVALID_CONFIG or IO, as ListenOn.
  static absl::StatusOr<std::unique_ptr<GrpcListener>> Open(
      const Options& options);

  // Once, before the server is built.
  void AddTo(grpc::ServerBuilder& builder);
  // Once the server has started.
  void Start() { acceptor_->Start(); }
  void Stop() { acceptor_->Stop(); }

  // The port of each address, in their order; 0 for unix sockets.
  const std::vector<int>& ports() const { return ports_; }
  // True if connections to the socket speak TLS.
  bool UsesTls(const ListeningSocket& socket) const {
    return options_.tls.has_value() && !socket.bound.is_unix();
  }
  Acceptor& acceptor() { return *acceptor_; }

 private:
  using GrpcAcceptor = grpc::experimental::ExternalConnectionAcceptor;

  explicit GrpcListener(const Options& options) : options_(options) {}
  void HandOver(const ListeningSocket& socket, int fd);

  const Options options_;
  std::vector<int> ports_;
  std::unique_ptr<GrpcAcceptor> plain_;
  std::unique_ptr<GrpcAcceptor> tls_;
  std::unique_ptr<Acceptor> acceptor_;
};

}  // namespace tactus::internal::server
