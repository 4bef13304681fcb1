// File: session.h
//
// The whole per-frame path with the default bundle: what a stream costs the
// server beside its messages.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows session/contact, ns a frame of a contact at 100 Hz from its first touch
// on, and session/idle, ns a frame without touch. Fails if the bundle does not
// give its stored answers.
std::unique_ptr<Benchmark> MakeSessionBenchmark();

}  // namespace tactus::client
