// File: noise.h
//
// Noise during training, so that the network does not rely on details: dropout
// of connections between layers (paper: "a dropout layer in between the two
// layers") and Gaussian noise of the inputs. Inference has neither.
//
//   TACTUS_RETURN_IF_ERROR(Validate(noise));
//   DropoutMask(noise.dropout, random, mask);  // at 0.2: 0 or 1.25
//
// Thread-safe: free functions; `random` belongs to the caller.
#pragma once

#include <span>

#include "absl/status/status.h"
#include "core/base/random.h"

namespace tactus {

struct LstmNoise {
  // Probability of dropping a connection between two LSTM layers.
  double dropout = 0;
  // Standard deviation of the noise that is added to every input.
  double input = 0;
};

// OK, or INVALID_CONFIG.
absl::Status Validate(const LstmNoise& noise);

// Fills `mask` with independent factors of mean 1 (Srivastava et al., JMLR
// 2014): 0 with `probability`, which is below 1 and rounded to 1/65536, else
// the same number above 1.
void DropoutMask(double probability, Random& random, std::span<float> mask);

}  // namespace tactus
