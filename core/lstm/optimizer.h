// File: optimizer.h
//
// One step downhill: RMSprop (Tieleman and Hinton, lecture 6.5, 2012; the
// paper's, with Keras's constants) or Adam (Kingma and Ba, ICLR 2015), with
// weight decay decoupled from the gradient (Loshchilov and Hutter, ICLR 2019).
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

namespace tactus {

enum class Optimizer { kRmsProp, kAdam };

struct OptimizerOptions {
  Optimizer optimizer = Optimizer::kRmsProp;
  double learning_rate = 1e-3;
  double rms_decay = 0.9;       // RMSprop: of the mean square
  double first_decay = 0.9;     // Adam: of the mean
  double second_decay = 0.999;  // Adam: of the mean square
  double epsilon = 1e-7;        // added to the root of the mean square
  // Share of a kernel, not of a bias, lost per step at learning rate 1.
  double weight_decay = 0;
  // Longest gradient, over all weights; longer ones are shortened. 0 = any.
  double gradient_clip = 0;
};

// Empty before the first step; the caller does not look inside.
struct OptimizerState {
  std::vector<float> mean;
  std::vector<float> mean_square;
  int64_t steps = 0;
};

// OK, or INVALID_CONFIG.
absl::Status Validate(const OptimizerOptions& options);

// Shortens `gradient`, one number per weight, to a norm of `longest` unless
// that is 0; returns the norm it had.
double ClipGradient(double longest, LstmNetwork& gradient);

// Moves the weights of `network` against `gradient`, of the same shape.
void OptimizerStep(const OptimizerOptions& options, double learning_rate,
                   const LstmNetwork& gradient, OptimizerState& state,
                   LstmNetwork& network);

}  // namespace tactus
