// File: backprop.h
//
// Back-propagation through time over whole sequences: the loss of a batch and
// its gradient by every weight.
//
//   LstmBackprop backprop(network);
//   backprop.SetWeights(network);
//   backprop.Forward(batch, {}, random);
//   const LstmBatchLoss loss = backprop.Loss(options);
//   backprop.Backward(gradient);
//
// What is sequential, the products of the recurrent weights, runs step by
// step; all other products run over all steps at once. Everything a step gives
// is kept until Backward(): about 16 floats per cell, sequence and step.
//
// Buffers grow to the largest batch and stay. Not thread-safe.
#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/base/random.h"
#include "core/lstm/batch_layout.h"
#include "core/lstm/kernels.h"
#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/packed_matrix.h"
#include "core/lstm/sequence.h"

namespace tactus {

// What training disturbs, so that the network relies on no detail.
struct LstmNoise {
  // Probability of dropping a connection between two LSTM layers.
  double dropout = 0;
  // Standard deviation of what is added to every input.
  double input = 0;
};

// OK, or INVALID_CONFIG.
absl::Status Validate(const LstmNoise& noise);

struct LstmBatchLoss {
  // Over the sequences, each times its weight.
  double sum = 0;
  // Sequences whose most likely class after the last step is their label.
  int correct = 0;
};

class LstmBackprop {
 public:
  // For networks of the shape of `network`, which is valid.
  explicit LstmBackprop(const LstmNetwork& network,
                        const LstmKernels& kernels = BestLstmKernels());

  void SetWeights(const LstmNetwork& network);

  // Runs `batch`, which is valid for the network and not empty.
  void Forward(std::span<const LstmSequence> batch, const LstmNoise& noise,
               Random& random);

  // Of the batch last run, which must still be there.
  LstmBatchLoss Loss(const LstmLossOptions& options);

  // The gradient of the mean loss last computed; overwrites `gradient`, which
  // has the network's shape.
  void Backward(LstmNetwork& gradient);

 private:
  struct Layer {
    PackedMatrix kernel;
    PackedMatrix recurrent;
    LstmBuffer bias;  // Padded(4H)
    LstmBuffer bias_gradient;
    // One row per sequence and step, of Padded(I), Padded(4H), Padded(H).
    LstmBuffer input, mask;  // above the first layer, with dropout only
    LstmBuffer gates, deltas;
    LstmBuffer cell, squashed, output, by_output;
    // One row per sequence.
    LstmBuffer from_next, carry;

    int cells() const { return recurrent.inputs; }
  };

  void Resize();
  void TakeInputs(double noise, Random& random);
  void DropInputs(size_t layer, double dropout, Random& random);
  const LstmBuffer& InputOf(size_t layer) const;
  void ForwardLayer(size_t layer);
  void BackwardLayer(size_t layer);
  void WeightGradients(size_t layer);
  LstmCellShape ShapeOf(const Layer& layer, int rows) const;

  const LstmKernels& kernels_;
  Activation activation_;
  GateActivation gate_activation_;
  int classes_;
  int regressions_;
  std::vector<Layer> layers_;
  PackedMatrix dense_;
  LstmBuffer dense_bias_, dense_bias_gradient_;
  // One row of Padded(classes + 2R) per sequence and step.
  LstmBuffer outputs_, by_outputs_;
  // What comes before the first step.
  LstmBuffer zeros_;

  // Of the batch last run.
  std::span<const LstmSequence> batch_;
  bool dropping_ = false;
  BatchLayout layout_;
  std::vector<int> steps_;
};

}  // namespace tactus
