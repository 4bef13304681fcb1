// File: startup.h
//
// What tactusd costs before it does anything: the time from its start until it
// says SERVING, and the memory of a stream that waits for a touch.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows startup/serving; startup/stream_memory of streams that are configured
// and share 8 connections, _played once each had its first frame; and
// startup/connection_memory of configured streams with a connection each.
std::unique_ptr<Benchmark> MakeStartupBenchmark();

}  // namespace tactus::client
