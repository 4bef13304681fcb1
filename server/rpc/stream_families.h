// File: stream_families.h
//
// What streams have done, as Prometheus reads it.
//
//   CollectStreams(lanes, gate, skipped, &families);
//
// Thread-safe: a free function without state.
#pragma once

#include <span>

#include "server/metrics/families.h"
#include "server/metrics/lane_metrics.h"
#include "server/ops/skip_totals.h"
#include "server/ops/stream_gate.h"

namespace tactus::internal::server {

// `lanes`: one per thread. `skipped`: of streams that have ended.
void CollectStreams(std::span<const LaneMetrics* const> lanes,
                    const StreamGate& gate, const SkipTotals& skipped,
                    Families* families);

}  // namespace tactus::internal::server
