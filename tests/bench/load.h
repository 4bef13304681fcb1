// File: load.h
//
// How many robots one tactusd serves, the load generator of client/load beside
// it on the same processors.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows load/200x100_p50, _p99 and _lost, and load/max_robots_1_per_message and
// _4_per_message: robots at 100 Hz that lose nothing and keep the p99 from
// due time to answer under 10 ms.
std::unique_ptr<Benchmark> MakeLoadBenchmark();

}  // namespace tactus::client
