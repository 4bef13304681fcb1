// File: server.h
//
// TactusServer: all services on their addresses, from start to drained stop.
//
//   TACTUS_ASSIGN_OR_RETURN(auto server, TactusServer::Start(&registry, {}));
//   // ... until the process is to end ...
//   server->Stop();
//
// Thread-safe but for Stop, which is called once. `models` must outlive it.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/limits.h"
#include "grpcpp/channel.h"
#include "grpcpp/server.h"
#include "server/ops/tls.h"
#include "server/rpc/contact_service.h"
#include "server/rpc/health_service.h"

namespace tactus::server {

class TactusServer {
 public:
  struct Options {
    // "host:port" (port 0: any free one) or "unix:path"; may be empty, the
    // in-process channel is always there.
    std::vector<std::string> listen = {};
    // TLS on every host:port; unix sockets stay plain.
    std::optional<TlsIdentity> tls = {};
    // That serve calls; 0: half as many as there are processors.
    int threads = 0;
    int max_streams = limits::kMaxStreams;
    // 0 means none.
    int idle_timeout_ms = limits::kIdleTimeoutMs;
    int drain_grace_ms = limits::kDrainGraceMs;
  };

  // Serving when it returns. IO if an address cannot be listened on, also
  // because certificate and key do not make a pair.
  static absl::StatusOr<std::unique_ptr<TactusServer>> Start(
      const ModelSource* models, const Options& options);

  // Stops without grace if Stop was not called.
  ~TactusServer();

  // Reports NOT_SERVING, refuses new streams, lets those there are finish
  // within the grace, ends the rest with DRAINING. Returns within the grace
  // and a second.
  void Stop();

  // One per address; without meaning for unix sockets.
  const std::vector<int>& ports() const { return ports_; }
  std::shared_ptr<grpc::Channel> InProcessChannel();
  const StreamGate& gate() const { return contacts_.gate(); }
  const SkipTotals& skipped() const { return contacts_.skipped(); }

 private:
  TactusServer(const ModelSource* models, const Options& options);
  absl::Status Listen();
  void Serve();
  void SetServing(bool serving);
  // Cuts off what is left at `deadline`.
  void Shutdown(std::chrono::system_clock::time_point deadline);

  const Options options_;
  ContactService contacts_;
  HealthService health_;
  std::vector<int> ports_;
  std::vector<std::unique_ptr<CallQueue>> queues_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace tactus::server
