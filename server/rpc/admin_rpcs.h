// File: admin_rpcs.h
//
// The RPCs of AdminService.
//
//   AddAdminRpcs({.backend = backend,
//                 .streams = [&] { return gate.live(); },
//                 .drain = [] { kill(getpid(), SIGTERM); }},
//                control);
//
// What the options refer to must outlive the calls. Not thread-safe: call it
// before the server starts.
#pragma once

#include <cstdint>
#include <functional>

#include "server/jobs/training_backend.h"
#include "server/rpc/control_service.h"

namespace tactus::internal::server {

struct AdminOptions {
  // Null without a data directory.
  TrainingBackend* backend = nullptr;
  // The number of open streams.
  std::function<int()> streams;
  int max_streams = 0;
  int max_streams_per_client = 0;
  int64_t drain_grace_ms = 0;
  // Begins to end the server; called on a worker's thread, when the answer is
  // on its way. Without it there is no RPC Drain.
  std::function<void()> drain;
};

void AddAdminRpcs(const AdminOptions& options, ControlService& control);

}  // namespace tactus::internal::server
