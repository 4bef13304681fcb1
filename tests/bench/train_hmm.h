// File: train_hmm.h
//
// Time of Baum-Welch on one core, against libghmm from the same start on the
// same trials.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Row train-hmm/iteration: ns per frame and iteration, a left-right model of 10
// states and 3 features; its error is how far apart the two log-likelihoods are
// when both have converged.
std::unique_ptr<Benchmark> MakeTrainHmmBenchmark();

}  // namespace tactus::client
