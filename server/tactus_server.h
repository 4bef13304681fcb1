// File: tactus_server.h
//
// TactusServer: all services on their addresses, from start to drained stop.
//
//   TACTUS_ASSIGN_OR_RETURN(auto server, TactusServer::Start(&registry, {}));
//   // ... until the process is to end ...
//   server->Stop();
//
// Thread-safe but for AnnounceStop and Stop, which are called once. `models`
// must outlive it.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/limits.h"
#include "grpcpp/channel.h"
#include "grpcpp/server.h"
#include "server/contact_log/contact_log.h"
#include "server/jobs/training_backend.h"
#include "server/listen/grpc_listener.h"
#include "server/metrics/server_metrics.h"
#include "server/ops/authorizer.h"
#include "server/ops/guarded_credentials.h"
#include "server/ops/tls.h"
#include "server/rpc/contact_service.h"
#include "server/rpc/control_service.h"
#include "server/rpc/health_service.h"

namespace tactus::internal::server {

class TactusServer {
 public:
  struct Options {
    // "host:port" (port 0: any free one) or "unix:path"; may be empty, because
    // the in-process channel is always there.
    std::vector<std::string> listen = {};
    // TLS on every host:port; unix sockets stay plain.
    std::optional<TlsIdentity> tls = {};
    // That serve calls; 0: half as many as there are processors.
    int threads = 0;
    int max_streams = limits::kMaxStreams;
    int max_connections = limits::kMaxConnections;
    // From one IPv4 address or IPv6 /64; unix sockets have no limit per peer.
    int max_connections_per_peer = limits::kMaxConnectionsPerPeer;
    int handshake_timeout_ms = limits::kHandshakeTimeoutMs;
    // Closes a connection without calls after this time.
    int connection_idle_ms = limits::kConnectionIdleMs;
    // 0 means none, for each of these.
    int max_streams_per_peer = limits::kMaxStreamsPerPeer;
    // A client is a token, a certificate or, without credentials, a peer.
    int max_streams_per_client = 0;
    int first_message_timeout_ms = limits::kFirstMessageTimeoutMs;
    int idle_timeout_ms = limits::kIdleTimeoutMs;
    int drain_grace_ms = limits::kDrainGraceMs;
    // Serve grpc.reflection, from which tools learn the services.
    bool reflection = false;
    // Serves data, jobs and models; null: those RPCs end with
    // NO_DATA_DIRECTORY. Must outlive the server.
    TrainingBackend* training = nullptr;
    // Keeps contacts; null: none are kept. Must outlive the server.
    ContactLog* contact_log = nullptr;
    // Decides who may call what; null: as an Authorizer without a tokens file.
    // Must outlive the server.
    const Authorizer* authorizer = nullptr;
    // What the RPC Drain does, on a thread of the server: lets another thread
    // call Stop. Without it the server has no such RPC.
    std::function<void()> on_drain = {};
  };

  // Serving when it returns. INVALID_CONFIG or IO if an address is wrong or
  // cannot be listened on, or if certificate and key do not make a pair.
  static absl::StatusOr<std::unique_ptr<TactusServer>> Start(
      const ModelSource* models, const Options& options);

  // Stops without grace if Stop was not called.
  ~TactusServer();

  // Reports NOT_SERVING, and goes on to serve: a proxy that asks for the health
  // gives its next streams to others. Stop comes later.
  void AnnounceStop() { SetServing(false); }

  // Reports NOT_SERVING, refuses new streams, lets those there are finish
  // within the grace, ends the rest with DRAINING. Returns within the grace
  // and a second.
  void Stop();

  // One per address; 0 for unix sockets.
  const std::vector<int>& ports() const { return listener_->ports(); }
  // For the self-check, which must end before Stop is called.
  GrpcListener* listener() { return listener_.get(); }
  std::shared_ptr<grpc::Channel> InProcessChannel();
  const StreamGate& gate() const { return contacts_.gate(); }
  const StreamGate& watch_gate() const { return health_.watch_gate(); }
  const ArrivalGate& arrivals() const { return arrivals_; }
  const SkipTotals& skipped() const { return contacts_.skipped(); }

  // All that the server counts (docs/monitoring.md).
  Families CollectMetrics() const;

 private:
  TactusServer(const ModelSource* models, const Options& options);
  absl::Status Listen();
  void Serve();
  void SetServing(bool serving);
  // Cuts off what is left at `deadline`.
  void Shutdown(std::chrono::system_clock::time_point deadline);

  const Options options_;
  const ModelSource* const models_;
  const Authorizer without_tokens_;
  ServerMetrics metrics_;
  const int64_t start_ms_;
  ArrivalGate arrivals_{limits::kMaxWaitingCalls};
  CallRefuser refuser_{&arrivals_};
  ContactService contacts_;
  HealthService health_;
  ControlService control_;
  std::vector<std::unique_ptr<CallQueue>> queues_;
  std::unique_ptr<GrpcListener> listener_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace tactus::internal::server
