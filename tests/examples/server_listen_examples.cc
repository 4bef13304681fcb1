// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "grpcpp/server_builder.h"
#include "server/listen/acceptor.h"
#include "server/listen/connection_table.h"
#include "server/listen/descriptor_limit.h"
#include "server/listen/file_descriptor.h"
#include "server/listen/grpc_listener.h"
#include "server/listen/listener_probe.h"
#include "server/listen/listening_socket.h"
#include "server/listen/self_check.h"
#include "server/listen/socket_address.h"
#include "server/ops/clock.h"
#include "server/ops/log_limiter.h"
#include "server/ops/logging.h"
#include "server/ops/peer.h"
#include "server/ops/service_notify.h"
#include "spdlog/spdlog.h"

namespace tactus::server::examples {

void AcceptorExample(std::vector<ListeningSocket> sockets) {
  Acceptor acceptor(std::move(sockets), {}, [](const auto& socket, int fd) {
    // ... owns fd from here on ...
  });
  acceptor.Start();
  // ... until the process is to end ...
  acceptor.Stop();
}

void ConnectionTableExample(int fd, const SocketAddress& address) {
  ConnectionTable table({.connections = 4096, .per_peer = 2048});
  const std::string peer = PeerOfHost(address.HostText());
  if (table.Admit(fd, peer) != Verdict::kAdmitted) close(fd);
}

void DescriptorLimitExample() {
  const int connections = ConnectionsThatFit(RaiseDescriptorLimit());
}

absl::Status FileDescriptorExample() {
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return IoError("socket", "closed");
  return absl::OkStatus();
}

absl::Status GrpcListenerExample(const GrpcListener::Options& options,
                                 grpc::ServerBuilder& builder,
                                 std::unique_ptr<grpc::Server>& server) {
  TACTUS_ASSIGN_OR_RETURN(auto listener, GrpcListener::Open(options));
  listener->AddTo(builder);
  server = builder.BuildAndStart();
  listener->Start();
  // ... until the process is to end ...
  listener->Stop();  // before server->Shutdown()
  return absl::OkStatus();
}

void ListenerProbeExample(Acceptor& acceptor, const ListeningSocket& socket) {
  ListenerProbe probe(&acceptor, socket.bound, /*tls=*/true);
  absl::Status status = probe.Run(std::chrono::seconds(2));
}

absl::Status ListeningSocketExample() {
  TACTUS_ASSIGN_OR_RETURN(auto sockets, ListenOn("127.0.0.1:50051"));
  sockets.front().bound.port();
  return absl::OkStatus();
}

void PingWatchdog();
void LogAndExit(const std::string& address, const absl::Status& error);

void SelfCheckExample(GrpcListener& listener) {
  SelfCheck check(&listener,
                  {.on_pass = PingWatchdog, .on_failure = LogAndExit});
}

void SocketAddressExample(int fd) {
  const SocketAddress peer = SocketAddress::OfPeer(fd);
  spdlog::info("a connection from {}", peer.HostText());
}

void LogLimiterExample() {
  LogLimiter limiter({.lines_per_second = 10, .burst = 100});
  if (const auto left_out = limiter.Admit(MonotonicNs())) {
    spdlog::warn("refused a connection{}", LeftOut(*left_out));
  }
}

absl::Status LoggingExample(const std::string& address) {
  TACTUS_RETURN_IF_ERROR(StartLogging("info"));
  spdlog::info("listening on {}", address);
  return absl::OkStatus();
}

void ServiceNotifyExample() {
  NotifyService("READY=1");
  NotifyService("WATCHDOG=1");  // more often than the unit's WatchdogSec
}

}  // namespace tactus::server::examples
