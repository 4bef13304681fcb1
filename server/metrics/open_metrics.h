// File: open_metrics.h
//
// Metrics as OpenMetrics 1.0 text, which prometheus-cpp does not write.
//
//   std::string text = OpenMetricsText(families);
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "server/metrics/families.h"

namespace tactus::internal::server {

inline constexpr char kOpenMetricsType[] =
    "application/openmetrics-text; version=1.0.0; charset=utf-8";

// Names of counters end in "_total".
std::string OpenMetricsText(const Families& families);

}  // namespace tactus::internal::server
