// File: train_lstm.h
//
// One step of LSTM training against PyTorch.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Row train-lstm/step: ms for one batch of five contacts of 500 frames through
// two layers of 50 cells: forward, backward, RMSprop, without dropout, as its
// random numbers would differ. The error is that of the gradient as a share of
// its largest number; more than 1e-4 fails.
std::unique_ptr<Benchmark> MakeTrainLstmBenchmark();

}  // namespace tactus::client
