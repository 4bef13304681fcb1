// File: gradient.h
//
// The loss of a batch and its gradient, as a pure function: to check training,
// and to write another optimizer.
//
//   TACTUS_ASSIGN_OR_RETURN(LstmGradient at,
//                           LossAndGradient(network, batch, {}));
//   ... at.loss, at.gradient.layers[0].kernel[3] ...
//
// Thread-safe: a free function.
#pragma once

#include <cstdint>
#include <span>

#include "absl/status/statusor.h"
#include "core/lstm/backprop.h"
#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/sequence.h"

namespace tactus::internal {

struct LstmGradient {
  // Mean over the batch.
  double loss = 0;
  // The loss by each weight of the network, in its place.
  LstmNetwork gradient;
};

// The same `seed` gives the same noise. INVALID_MODEL, INVALID_TRAINING_DATA
// or INVALID_CONFIG for a bad argument.
absl::StatusOr<LstmGradient> LossAndGradient(
    const LstmNetwork& network, std::span<const LstmSequence> batch,
    const LstmLossOptions& options, const LstmNoise& noise = {},
    uint64_t seed = 0);

}  // namespace tactus::internal
