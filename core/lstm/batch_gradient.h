// File: batch_gradient.h
//
// BatchGradient: the gradient of a batch, of which each shard is computed by
// one rank.
//
//   BatchGradient batches(network, source, options, ranks);
//   TACTUS_ASSIGN_OR_RETURN(const LstmBatchLoss loss,
//                           batches.Compute(network, numbers, step, gradient));
//
// The shards' gradients are summed in their order, so the bits depend on the
// number of shards and not on that of ranks. One shard is the whole batch.
// A rank reads only the sequences of the shards that it computes.
//
// Refers to its arguments. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/ranks.h"
#include "core/lstm/backprop.h"
#include "core/lstm/network.h"
#include "core/lstm/sequence.h"
#include "core/lstm/sequence_source.h"
#include "core/lstm/train.h"

namespace tactus::internal {

class BatchGradient {
 public:
  // network: valid. Later networks must have the same shape.
  BatchGradient(const LstmNetwork& network, LstmSequenceSource& training,
                const LstmTrainOptions& options, Ranks& ranks);

  // Writes the gradient of the batch's mean loss to `gradient`, of the
  // network's shape. `numbers`: the sequences of the batch, at least one.
  // `step`: batches before it, which decides the noise.
  absl::StatusOr<LstmBatchLoss> Compute(const LstmNetwork& network,
                                        std::span<const size_t> numbers,
                                        uint64_t step, LstmNetwork& gradient);

 private:
  LstmBatchLoss ComputeShard(std::span<const size_t> numbers, uint64_t stream,
                             LstmNetwork& gradient);
  absl::StatusOr<LstmBatchLoss> ComputeShards(std::span<const size_t> numbers,
                                              size_t shards, uint64_t step,
                                              LstmNetwork& gradient);

  LstmSequenceSource& training_;
  const LstmTrainOptions& options_;
  Ranks& ranks_;
  LstmBackprop backprop_;
  std::vector<LstmSequence> batch_;
  std::string mine_;
};

}  // namespace tactus::internal
