// File: plain_lstm.h
//
// The LSTM of core/lstm in plain loops and double precision, straight from its
// equations: the reference for the fast one.
#pragma once

#include <vector>

#include "core/lstm/network.h"

namespace tactus {

// Probability per class after each step of `inputs`, [T][classes].
std::vector<std::vector<double>> PlainLstm(
    const LstmNetwork& network, const std::vector<std::vector<double>>& inputs);

}  // namespace tactus
