// File: hmm.h
//
// Time to score one frame with HMMs, against libghmm, and how far the score of
// a long contact is from long double.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows hmm/forward and hmm/viterbi: ns per frame and model, 4 left-right models
// of 10 states and 3 features; hmm/default-bundle: ns per frame of the default
// bundle's shape, 4 categories of 20 such models.
std::unique_ptr<Benchmark> MakeHmmBenchmark();

}  // namespace tactus::client
