// File: lane_metrics.h
//
// LaneMetrics: what the streams of one queue's thread have done. Each thread
// has its own, so that they do not share a cache line.
//
//   lane.frames.fetch_add(batch.frame_count(), std::memory_order_relaxed);
//
// Written by one thread, read by any.
#pragma once

#include <atomic>
#include <cstdint>

#include "server/metrics/histogram.h"

namespace tactus::internal::server {

struct alignas(64) LaneMetrics {
  std::atomic<uint64_t> frames = 0;
  std::atomic<uint64_t> frames_missing = 0;
  std::atomic<uint64_t> messages_received = 0;
  std::atomic<uint64_t> messages_sent = 0;
  std::atomic<uint64_t> superseded = 0;
  // Seconds that a frame took.
  Histogram processing{kFrameSeconds};
  // Seconds that an answer waited until it was written.
  Histogram waiting{kFrameSeconds};
};

}  // namespace tactus::internal::server
