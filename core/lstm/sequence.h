// File: sequence.h
//
// LstmSequence: one training trial of an LSTM, as a view of the caller's
// numbers.
//
//   LstmSequence sequence;
//   sequence.inputs = frames;  // T x I
//   sequence.label = 2;
//
// Plain data. Owns nothing: the viewed arrays must outlive it.
#pragma once

#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "core/lstm/network.h"

namespace tactus::internal {

struct LstmSequence {
  // T x I, row-major, scaled as for inference; T of at least 1.
  std::span<const float> inputs = {};
  // The class, from 0.
  int label = 0;
  // T: the class at each step, where it changes. Empty: `label` at every step.
  std::span<const int16_t> step_labels = {};
  // T x R, row-major: the targets of the regressions after each step. Empty if
  // the sequence has no targets.
  std::span<const float> targets = {};
  // Weight of the sequence's loss.
  float weight = 1;

  int LabelAt(int step) const {
    return step_labels.empty() ? label : step_labels[step];
  }
};

// OK if `sequences` fit `network`, which is valid, and every number is finite;
// else INVALID_TRAINING_DATA naming the sequence.
absl::Status Validate(std::span<const LstmSequence> sequences,
                      const LstmNetwork& network);

}  // namespace tactus::internal
