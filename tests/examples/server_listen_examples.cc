// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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

namespace tactus::internal::server::examples {

static void AcceptorExample(std::vector<ListeningSocket> sockets) {
#include "server/listen/acceptor.h.inc"
}

static void ConnectionTableExample(int fd, const SocketAddress& address) {
#include "server/listen/connection_table.h.inc"
}

static void DescriptorLimitExample() {
#include "server/listen/descriptor_limit.h.inc"
}

static absl::Status FileDescriptorExample() {
#include "server/listen/file_descriptor.h.inc"
  return absl::OkStatus();
}

static absl::Status GrpcListenerExample(const GrpcListener::Options& options,
                                        grpc::ServerBuilder& builder,
                                        std::unique_ptr<grpc::Server>& server) {
#include "server/listen/grpc_listener.h.inc"
  return absl::OkStatus();
}

static void ListenerProbeExample(Acceptor& acceptor,
                                 const ListeningSocket& socket) {
#include "server/listen/listener_probe.h.inc"
}

static absl::Status ListeningSocketExample() {
#include "server/listen/listening_socket.h.inc"
  return absl::OkStatus();
}

void PingWatchdog();
void LogAndExit(const std::string& address, const absl::Status& error);

static void SelfCheckExample(GrpcListener& listener) {
#include "server/listen/self_check.h.inc"
}

static void SocketAddressExample(int fd) {
#include "server/listen/socket_address.h.inc"
}

static void LogLimiterExample() {
#include "server/ops/log_limiter.h.inc"
}

static absl::Status LoggingExample(const std::string& address) {
#include "server/ops/logging.h.inc"
  return absl::OkStatus();
}

static void ServiceNotifyExample() {
#include "server/ops/service_notify.h.inc"
}

}  // namespace tactus::internal::server::examples
