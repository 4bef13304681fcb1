#include "server/start_checks.h"

#include <algorithm>

#include "core/base/address.h"
#include "server/listen/descriptor_limit.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {

void FitConnections(bool behind_proxy, TactusServer::Options& options) {
  const int descriptors = RaiseDescriptorLimit();
  const int fit = ConnectionsThatFit(descriptors);
  if (options.max_connections > fit) {
    spdlog::warn(
        "serving at most {} connections, because at most {} files may "
        "be open (ulimit -n)",
        fit, descriptors);
    options.max_connections = fit;
  }
  if (behind_proxy) {
    options.max_connections_per_peer = options.max_connections;
    options.max_streams_per_peer = 0;
    return;
  }
  // One peer never takes all, so that others can still connect.
  options.max_connections_per_peer =
      std::min(options.max_connections_per_peer,
               std::max(1, options.max_connections / 2));
}

void LogListeners(const TactusServer::Options& options,
                  const TactusServer& server) {
  for (size_t i = 0; i < options.listen.size(); ++i) {
    const std::string& address = options.listen[i];
    if (IsUnixAddress(address)) {
      spdlog::info("listening on {}, plaintext", address);
    } else {
      spdlog::info("listening on {}, port {}, {}", address, server.ports()[i],
                   options.tls ? "TLS" : "plaintext");
    }
  }
}

void WarnOfDirectListeners(const std::vector<std::string>& addresses) {
  for (const std::string& address : addresses) {
    if (StaysOnThisHost(address)) continue;
    spdlog::warn(
        "{} is open to other hosts: unless only a proxy reaches it, hostile "
        "hosts can slow down the streams, and a fault of gRPC can end this "
        "process; see \"A proxy in front\" in docs/security.md",
        address);
  }
}

}  // namespace tactus::internal::server
