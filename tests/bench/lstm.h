// File: lstm.h
//
// LSTM networks stepped one frame at a time, against PyTorch.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows lstm/step and lstm/step_tuned: ns a frame of one stream, two layers of
// 50 cells, with the paper's three inputs and with those of the tuned preset.
// lstm/batch64: ns a frame of 64 streams in step. The error is that of the
// probabilities; more than 1e-5 fails.
std::unique_ptr<Benchmark> MakeLstmBenchmark();

}  // namespace tactus::client
