// File: idle.h
//
// How long the first frame after a silence waits for its answer: on an idle
// server that is the moment a touch begins.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows idle/first_frame_p50, _p90, _p99 and _max, in ms from sending a frame to
// its posterior.
std::unique_ptr<Benchmark> MakeIdleBenchmark();

}  // namespace tactus::client
