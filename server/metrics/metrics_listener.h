// File: metrics_listener.h
//
// MetricsListener: lets Prometheus read the metrics of a server. It has its own
// address and answers GET /metrics there, as text or as OpenMetrics.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto listener,
//                           MetricsListener::Start("9464", collect));
//   spdlog::info("metrics on port {}", listener->port());
//
// One thread serves at most kMaxConnections connections; those beyond are
// closed. A request has 8 KiB and no body, and must come within two seconds.
// Serving ends with the object.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/metrics/families.h"

namespace tactus::internal::server {

class MetricsListener {
 public:
  static constexpr int kMaxConnections = 64;
  // Called for each request, on the listener's thread.
  using Collect = std::function<Families()>;

  // `address` is "host:port", with a numeric host, or "port" for 127.0.0.1;
  // port 0 takes any free one. INVALID_CONFIG or IO.
  static absl::StatusOr<std::unique_ptr<MetricsListener>> Start(
      const std::string& address, Collect collect);
  ~MetricsListener();

  MetricsListener(const MetricsListener&) = delete;
  MetricsListener& operator=(const MetricsListener&) = delete;

  int port() const;

 private:
  class Impl;

  explicit MetricsListener(std::unique_ptr<Impl> impl);

  const std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::internal::server
