// File: start_checks.h
//
// What tactusd looks at when it starts: how many connections fit, and who can
// reach it.
//
//   FitConnections(behind_proxy, options);
//   LogListeners(options, *server);
//   WarnOfDirectListeners(options.listen);
//
// Free functions without state; they write to the log.
#pragma once

#include <string>
#include <vector>

#include "server/tactus_server.h"

namespace tactus::internal::server {

// Lowers the limits of connections to what the limit of open files allows.
// Behind a proxy, which is one peer, there are none per peer.
void FitConnections(bool behind_proxy, TactusServer::Options& options);

// Each address with its port.
void LogListeners(const TactusServer::Options& options,
                  const TactusServer& server);

// What bytes of a stranger can do to gRPC only a proxy stops.
void WarnOfDirectListeners(const std::vector<std::string>& addresses);

}  // namespace tactus::internal::server
