// File: optimizer.h
//
// One optimizer step: RMSprop (Tieleman and Hinton, lecture 6.5, 2012; used in
// the paper, here with Keras's constants) or Adam (Kingma and Ba, ICLR 2015),
// with weight decay decoupled from the gradient (Loshchilov and Hutter, ICLR
// 2019).
//
//   OptimizerState state;
//   const double norm = ClipGradient(1.0, gradient);
//   OptimizerStep(options, options.learning_rate, gradient, state, network);
//
// Thread-safe: free functions.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/lstm/network.h"

namespace tactus::internal {

enum class Optimizer { kRmsProp, kAdam };

struct OptimizerOptions {
  Optimizer optimizer = Optimizer::kRmsProp;
  double learning_rate = 1e-3;
  double rms_decay = 0.9;       // RMSprop: of the mean square
  double first_decay = 0.9;     // Adam: of the mean
  double second_decay = 0.999;  // Adam: of the mean square
  double epsilon = 1e-7;        // added to the root of the mean square
  // Fraction by which a step at learning rate 1 shrinks each kernel. Biases do
  // not shrink.
  double weight_decay = 0;
  // Largest norm of the gradient over all weights; larger ones are scaled down.
  // 0: no limit.
  double gradient_clip = 0;
};

// Empty before the first step. Internal to OptimizerStep.
struct OptimizerState {
  std::vector<float> mean;
  std::vector<float> mean_square;
  int64_t steps = 0;
};

// OK, or INVALID_CONFIG.
absl::Status Validate(const OptimizerOptions& options);

// Scales `gradient`, one number per weight, down to a norm of at most
// `longest`; 0: no limit. Returns the norm before.
double ClipGradient(double longest, LstmNetwork& gradient);

// Moves the weights of `network` against `gradient`, of the same shape.
void OptimizerStep(const OptimizerOptions& options, double learning_rate,
                   const LstmNetwork& gradient, OptimizerState& state,
                   LstmNetwork& network);

}  // namespace tactus::internal
