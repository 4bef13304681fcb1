// File: server_metrics.h
//
// ServerMetrics: what the calls of a server count, all in one place.
//
//   ServerMetrics metrics;
//   metrics.rpcs.Start(method);
//   metrics.refused_streams.Add(ReasonOf(status));
//
// Thread-safe, as its parts are.
#pragma once

#include "server/metrics/answer_metrics.h"
#include "server/metrics/reason_counts.h"
#include "server/metrics/rpc_metrics.h"

namespace tactus::internal::server {

struct ServerMetrics {
  RpcMetrics rpcs;
  AnswerMetrics answers;
  ReasonCounts refused_streams;
};

}  // namespace tactus::internal::server
