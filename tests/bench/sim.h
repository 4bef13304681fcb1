// File: sim.h
//
// Work and precision of the contact simulator: processor time on one core
// against the largest error of the noiseless features, for the exact method
// and for CVODE at several tolerances, on the same trials.
//
// Errors are shares of the feature's peak in the trial, against the
// independent integration of core/sim/model/reference.h; times are of the
// calling thread only.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows sim/paper-set, sim/exact-TOLERANCE, sim/CVODE-TOLERANCE and, with --all,
// sim/random-scenes; --table and --figure (work_precision.h) show the same.
// NUMERICAL_FAILURE if the exact method is off by more than it states. What
// was compared, and the worst scenes, go to stderr.
std::unique_ptr<Benchmark> MakeSimBenchmark();

}  // namespace tactus::client
