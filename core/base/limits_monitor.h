// File: limits_monitor.h
//
// Limits of those who watch streams.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// Calls that watch streams.
inline constexpr int kMaxWatchers = 16;
// Streams that one call shows with frames.
inline constexpr int kMaxWatchedStreams = 64;
// Frames a second that a watcher is shown of a stream.
inline constexpr uint32_t kMaxWatchedRateHz = 30;
// Events of a stream that wait for its watchers.
inline constexpr size_t kMaxWatchedEvents = 64;

}  // namespace tactus::internal::limits
