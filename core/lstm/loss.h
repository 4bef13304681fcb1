// File: loss.h
//
// The training loss of an LSTM. The loss of a step is the cross entropy of the
// class, plus regression_weight times the sum over regressions of their
// negative log-likelihood: (s + (y - m)^2 exp(-s)) / 2 for target y, mean m and
// log-variance s (without the constant log(2 pi) / 2). The loss of a sequence
// is its weight times the mean over its steps that count. The loss of a batch
// is the mean over its sequences.
//
//   loss += StepLoss(options, 4, 0, outputs, label, {}, 1.0 / steps, gradient);
//
// Thread-safe: free functions.
#pragma once

#include <span>

#include "absl/status/status.h"
#include "core/lstm/network.h"

namespace tactus::internal {

enum class LstmLoss { kLastStep, kEveryStep };

struct LstmLossOptions {
  LstmLoss steps = LstmLoss::kLastStep;
  // With kEveryStep: the first step that counts (from 0) and the distance to
  // each next one. The last step always counts.
  int first_step = 0;
  int stride = 1;
  // Fraction of the label that is spread evenly over all classes.
  double label_smoothing = 0;
  double regression_weight = 1;
};

// OK, or INVALID_CONFIG.
absl::Status Validate(const LstmLossOptions& options);

// Whether step `t` of `steps` counts.
bool Counts(const LstmLossOptions& options, int t, int steps);

// Returns `scale` times the loss of one step and writes `scale` times its
// gradient with respect to the outputs. `outputs` and `gradient` are rows of
// the dense layer: classes, means, log-variances. `targets` has R entries or
// none.
double StepLoss(const LstmLossOptions& options, int classes, int regressions,
                const float* outputs, int label, std::span<const float> targets,
                double scale, float* gradient);

}  // namespace tactus::internal
