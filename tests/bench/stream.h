// File: stream.h
//
// What a stream of tactusd costs above gRPC itself: one stream's throughput and
// round trip against an echo of messages of the same sizes, both as children of
// this process, in turns. And that echo by callbacks against one by a
// completion queue.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows stream/throughput, _rtt_p50, _server_cpu and _superseded with frames of
// contacts and of untouched skin by turns; stream/untouched_throughput and
// _rtt_p50 without contacts, where the models have little to do; and
// stream/echo_callback_vs_cq_throughput, _rtt_p50 and _server_cpu.
std::unique_ptr<Benchmark> MakeStreamBenchmark();

}  // namespace tactus::client
