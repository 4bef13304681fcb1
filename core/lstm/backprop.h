// File: backprop.h
//
// Back-propagation through time over whole sequences: computes the loss of a
// batch and its gradient with respect to every weight.
//
//   LstmBackprop backprop(network);
//   backprop.SetWeights(network);
//   backprop.Forward(batch, {}, random);
//   const LstmBatchLoss loss = backprop.Loss(options);
//   backprop.Backward(gradient);
//
// The products of the recurrent weights depend on the step before and run step
// by step. All other products run over all steps at once. The results of all
// steps are stored until Backward(): about 16 floats per cell, sequence and
// step.
//
// Buffers grow to the largest batch and are reused. Not thread-safe.
#pragma once

#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/lstm/batch_layout.h"
#include "core/lstm/kernels.h"
#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/noise.h"
#include "core/lstm/packed_matrix.h"
#include "core/lstm/sequence.h"

namespace tactus::internal {

struct LstmBatchLoss {
  // Sum of the sequences' losses, each times its weight.
  double sum = 0;
  // Number of sequences with the right label after the last step.
  int correct = 0;
};

class LstmBackprop {
 public:
  // network: valid. Later networks must have the same shape.
  explicit LstmBackprop(const LstmNetwork& network,
                        const LstmKernels& kernels = BestLstmKernels());

  void SetWeights(const LstmNetwork& network);

  // Runs the network on `batch`: valid for the network, not empty, and alive
  // until Backward() has returned.
  void Forward(std::span<const LstmSequence> batch, const LstmNoise& noise,
               Random& random);

  // The loss of the last batch.
  LstmBatchLoss Loss(const LstmLossOptions& options);

  // Writes the gradient of the mean loss that Loss() computed last. `gradient`
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
  void TakeInputs(double noise, NoiseBits& bits);
  void DropInputs(size_t layer, double dropout, NoiseBits& bits);
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
  // Output and cell before the first step.
  LstmBuffer zeros_;

  // The last batch.
  std::span<const LstmSequence> batch_;
  bool dropping_ = false;
  BatchLayout layout_;
  std::vector<int> steps_;
};

}  // namespace tactus::internal
