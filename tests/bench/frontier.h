// File: frontier.h
//
// Run time against error: classifiers of one kind of model in several sizes
// and paces, HMM scores in several precisions, and the simulator by several
// methods and tolerances, each on the same contacts, with the Pareto front.
//
// Models are fitted on the spot to the paper's trials and tested at robot
// conditions that were not trained at.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows frontier/LADDER/VARIANT; --table and --figures (frontier_point.h) show
// the same with the front. NUMERICAL_FAILURE if a precision or the exact
// simulator is off by more than it states, if parts of a model answer
// otherwise alone, if a skip rule changes an answer, or if answers are hardly
// better than guesses.
std::unique_ptr<Benchmark> MakeFrontierBenchmark();

}  // namespace tactus::client
