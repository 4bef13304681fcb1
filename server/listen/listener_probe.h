// File: listener_probe.h
//
// ListenerProbe: connects to one of this process's own listening sockets, as a
// client would, and waits until gRPC answers.
//
//   ListenerProbe probe(&acceptor, socket.bound, /*tls=*/true);
//   absl::Status status = probe.Run(std::chrono::seconds(2));
//
// The probe sends HTTP/2 settings and checks that the server acknowledges them,
// and that the server's own vet has seen them (core/http2): should gRPC ever
// read in another way, the check fails. It does not check the certificate,
// because it learns nothing from the answer but that there is one.
//
// Owned by one thread. `acceptor` must outlive it.
#pragma once

#include <chrono>
#include <memory>

#include "absl/status/status.h"
#include "server/listen/acceptor.h"

struct ssl_ctx_st;

namespace tactus::internal::server {

class ListenerProbe {
 public:
  // `bound` is where the socket listens.
  ListenerProbe(Acceptor* acceptor, const SocketAddress& bound, bool tls);

  // OK if the server answered. Each step may take `timeout`.
  absl::Status Run(std::chrono::milliseconds timeout);

 private:
  Acceptor* acceptor_;
  SocketAddress target_;
  // Null: plain.
  std::shared_ptr<ssl_ctx_st> tls_;
};

}  // namespace tactus::internal::server
