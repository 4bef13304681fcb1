// File: rpc_metrics.h
//
// RpcMetrics: calls by method and outcome, under gRPC's usual names
// (grpc_server_started_total, grpc_server_handled_total,
// grpc_server_handling_seconds).
//
//   metrics.Start("/tactus.v1.ModelService/ListAliases");
//   metrics.Handle("/tactus.v1.ModelService/ListAliases", status, seconds);
//   metrics.Collect(&families);
//
// Methods that the contract does not have are counted as one. Thread-safe;
// takes a lock, twice per call.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "server/metrics/families.h"
#include "server/metrics/histogram.h"

namespace tactus::internal::server {

class RpcMetrics {
 public:
  // `method`: "/tactus.v1.Service/Method".
  void Start(absl::string_view method);
  // The call ended with `code` after so many seconds.
  void Handle(absl::string_view method, absl::StatusCode code, double seconds);
  void Collect(Families* families) const;

 private:
  struct Method {
    Labels labels;
    uint64_t started = 0;
    std::map<absl::StatusCode, uint64_t> handled;
    Histogram seconds{kCallSeconds};
  };

  Method& Find(absl::string_view name);

  mutable std::mutex mutex_;
  std::map<std::string, Method, std::less<>> methods_;
};

}  // namespace tactus::internal::server
