// File: plain_lstm.h
//
// The LSTM of core/lstm in plain loops and double precision, written directly
// from its equations. The tests compare the fast one with it.
//
//   auto probability = PlainLstm(network, inputs);
//
// Thread-safe: free functions. Results own their arrays.
#pragma once

#include <span>
#include <vector>

#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/sequence.h"

namespace tactus::internal {

// Output of the dense layer after each step of `inputs`, [T][classes + 2R].
std::vector<std::vector<double>> PlainOutputs(
    const LstmNetwork& network, const std::vector<std::vector<double>>& inputs);

// Probability per class after each step of `inputs`, [T][classes].
std::vector<std::vector<double>> PlainLstm(
    const LstmNetwork& network, const std::vector<std::vector<double>>& inputs);

// Mean loss of a batch, as core/lstm/loss.h defines it.
double PlainLoss(const LstmNetwork& network,
                 std::span<const LstmSequence> batch,
                 const LstmLossOptions& options);

}  // namespace tactus::internal
