// File: train.h
//
// Trains an LSTM by back-propagation through time (paper, Section "Algorithm
// Parameters": RMSprop, cross entropy, dropout of 0.2 between the layers,
// batches of 5, 10 epochs; these are the defaults here).
//
//   LstmTrainOptions options;
//   options.loss.steps = LstmLoss::kEveryStep;
//   options.patience = 5;
//   TACTUS_ASSIGN_OR_RETURN(
//       LstmTrained trained,
//       TrainLstm({.network = network}, training, validation, options));
//
// A checkpoint is passed on after every epoch and holds the complete state:
// TrainLstm(checkpoint, ...) with the same data and options gives the same bits
// as the training without interruption.
//
// The same seed gives the same bits, however wide the CPU's vectors are and
// however many ranks train.
// Thread-safe: a free function that starts no thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/ranks.h"
#include "core/lstm/backprop.h"
#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/optimizer.h"
#include "core/lstm/sequence.h"
#include "core/lstm/sequence_source.h"

namespace tactus::internal {

struct LstmTrainOptions {
  int epochs = 10;
  int batch_size = 5;
  OptimizerOptions optimizer = {};
  // The learning rate falls to 0 along half a cosine over all epochs.
  bool cosine_decay = false;
  LstmLossOptions loss = {};
  LstmNoise noise = {.dropout = 0.2, .input = 0};
  // Seeds the order of the sequences and the noise.
  uint64_t seed = 1;
  // Stops after this many epochs without a lower validation loss and returns
  // the network of the epoch with the lowest. 0: trains all epochs and returns
  // the last network.
  int patience = 0;
  // Each batch is cut into so many shards, at most. Their gradients are
  // computed one by one, by several ranks if there are some, and summed in
  // their order.
  int shards = 1;
};

struct LstmEpoch {
  int epoch = 0;  // from 1
  // Mean over the epoch's batches, with noise, while the weights changed.
  double train_loss = 0;
  double train_accuracy = 0;  // after the last step
  // After the epoch, without noise; 0 without validation sequences.
  double validation_loss = 0;
  double validation_accuracy = 0;
};

struct LstmCheckpoint {
  LstmNetwork network;
  OptimizerState optimizer = {};
  std::vector<LstmEpoch> history = {};  // epochs done
  // With patience: the best epoch so far and its network.
  int best_epoch = 0;
  LstmNetwork best = {};
};

struct LstmTrained {
  LstmNetwork network;
  int epoch = 0;  // of the network
  std::vector<LstmEpoch> history;
};

// Called after every epoch. An error ends the training and is returned.
using LstmEpochSink =
    absl::FunctionRef<absl::Status(const LstmEpoch&, const LstmCheckpoint&)>;

inline absl::Status IgnoreEpoch(const LstmEpoch&, const LstmCheckpoint&) {
  return absl::OkStatus();
}

// Called before every batch. An error ends the training and is returned.
using LstmBatchCheck = absl::FunctionRef<absl::Status()>;

inline absl::Status GoOn() { return absl::OkStatus(); }

// Starts from `from.network`, or continues from a checkpoint. `validation` may
// be empty if patience is 0. INVALID_MODEL, INVALID_TRAINING_DATA or
// INVALID_CONFIG for a bad argument; NUMERICAL_FAILURE if the loss or a weight
// overflows.
absl::StatusOr<LstmTrained> TrainLstm(LstmCheckpoint from,
                                      std::span<const LstmSequence> training,
                                      std::span<const LstmSequence> validation,
                                      const LstmTrainOptions& options,
                                      LstmEpochSink on_epoch = IgnoreEpoch,
                                      LstmBatchCheck before_batch = GoOn);

// The same with sequences of a source, which must be valid. All `ranks`, if
// there are some, must call it with the same arguments; each does some of the
// shards and gets the network.
absl::StatusOr<LstmTrained> TrainLstm(LstmCheckpoint from,
                                      LstmSequenceSource& training,
                                      std::span<const LstmSequence> validation,
                                      const LstmTrainOptions& options,
                                      LstmEpochSink on_epoch = IgnoreEpoch,
                                      LstmBatchCheck before_batch = GoOn,
                                      Ranks* ranks = nullptr);

}  // namespace tactus::internal
