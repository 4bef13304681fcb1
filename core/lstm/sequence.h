// File: sequence.h
//
// One trial to train an LSTM with, as a view of numbers someone else holds.
//
//   LstmSequence sequence;
//   sequence.inputs = frames;  // T x I
//   sequence.label = 2;
//
// Plain data. Owns nothing: what it views must outlive it.
#pragma once

#include <span>

#include "absl/status/status.h"
#include "core/lstm/network.h"

namespace tactus {

struct LstmSequence {
  // T x I, row-major, scaled as for inference; T of at least 1.
  std::span<const float> inputs = {};
  // The class, from 0.
  int label = 0;
  // T x R, row-major: what the regressions should say after each step; empty
  // if the sequence has nothing to say of them.
  std::span<const float> targets = {};
  // Of its loss.
  float weight = 1;
};

// OK if `sequences` fit `network`, which is valid, and every number is finite;
// else INVALID_TRAINING_DATA naming the sequence.
absl::Status Validate(std::span<const LstmSequence> sequences,
                      const LstmNetwork& network);

}  // namespace tactus
