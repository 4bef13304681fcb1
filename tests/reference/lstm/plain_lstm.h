// File: plain_lstm.h
//
// The LSTM of core/lstm in plain loops and double precision, straight from its
// equations: the reference for the fast one.
#pragma once

#include <span>
#include <vector>

#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/sequence.h"

namespace tactus {

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

}  // namespace tactus
