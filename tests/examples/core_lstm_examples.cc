// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/lstm/backprop.h"
#include "core/lstm/batch_layout.h"
#include "core/lstm/kernels.h"
#include "core/lstm/loss.h"
#include "core/lstm/network.h"
#include "core/lstm/noise.h"
#include "core/lstm/optimizer.h"
#include "core/lstm/packed_matrix.h"
#include "core/lstm/sequence.h"
#include "core/lstm/sequence_source.h"
#include "core/lstm/stepper.h"
#include "core/lstm/train.h"
#include "core/lstm/vector_math.h"

namespace tactus::examples {

void Use(std::span<const double> probability);

void BackpropExample(const LstmNetwork& network,
                     std::span<const LstmSequence> batch, Random& random,
                     const LstmLossOptions& options, LstmNetwork& gradient) {
  LstmBackprop backprop(network);
  backprop.SetWeights(network);
  backprop.Forward(batch, {}, random);
  const LstmBatchLoss loss = backprop.Loss(options);
  backprop.Backward(gradient);
}

void BatchLayoutExample() {
  const int steps[] = {4, 9, 9};
  BatchLayout layout;
  layout.Arrange(steps);
}

absl::Status NoiseExample(const LstmNoise& noise, Random& random,
                          std::span<float> mask, std::span<float> inputs) {
  TACTUS_RETURN_IF_ERROR(Validate(noise));
  NoiseBits bits(random);
  DropoutMask(noise.dropout, bits, mask);  // at 0.2: 0 or 1.25
  AddNoise(noise.input, bits, inputs);
  return absl::OkStatus();
}

void SequenceSourceExample(LstmSequenceSource& source) {
  std::vector<LstmSequence> batch;
  const size_t numbers[] = {4, 17};
  source.Get(numbers, batch);  // valid until the next Get()
}

void KernelsExample(const float* input, const float* weights) {
  LstmBuffer c(5 * Padded(200));
  BestLstmKernels().product({.rows = 5,
                             .inner = 50,
                             .columns = Padded(200),
                             .a = input,
                             .a_row = 50,
                             .b = weights,
                             .b_row = Padded(200),
                             .c = c.data(),
                             .c_row = Padded(200)});
}

void LossExample(const LstmLossOptions& options, const float* outputs,
                 int label, int steps, float* gradient) {
  double loss = 0;
  loss += StepLoss(options, 4, 0, outputs, label, {}, 1.0 / steps, gradient);
}

absl::Status NetworkExample(uint64_t seed) {
  LstmNetwork network = RandomNetwork(2, {50, 50}, 4, Activation::kSoftsign,
                                      GateActivation::kHardSigmoid, seed);
  TACTUS_ASSIGN_OR_RETURN(CompiledLstm lstm, CompiledLstm::Create(network));
  return absl::OkStatus();
}

void OptimizerExample(const OptimizerOptions& options, LstmNetwork& gradient,
                      LstmNetwork& network) {
  OptimizerState state;
  const double norm = ClipGradient(1.0, gradient);
  OptimizerStep(options, options.learning_rate, gradient, state, network);
}

void PackedMatrixExample(const LstmLayer& layer) {
  PackedMatrix matrix(200, 50);
  matrix.SetWeights(layer.recurrent);
}

void SequenceExample(std::span<const float> frames) {
  LstmSequence sequence;
  sequence.inputs = frames;
  sequence.label = 2;
}

absl::Status StepperExample(
    const LstmNetwork& network,
    const std::vector<std::vector<double>>& scaled_features) {
  TACTUS_ASSIGN_OR_RETURN(CompiledLstm lstm, CompiledLstm::Create(network));
  LstmStepper stepper(lstm);
  for (const auto& features : scaled_features) {
    stepper.Step(features);
    Use(stepper.probability());
  }
  return absl::OkStatus();
}

absl::Status TrainExample(const LstmNetwork& network,
                          std::span<const LstmSequence> training,
                          std::span<const LstmSequence> validation) {
  LstmTrainOptions options;
  options.loss.steps = LstmLoss::kEveryStep;
  options.patience = 5;
  TACTUS_ASSIGN_OR_RETURN(
      LstmTrained trained,
      TrainLstm({.network = network}, training, validation, options));
  return absl::OkStatus();
}

void VectorMathExample(const float* from) {
  Lanes<8>::Floats x;
  Load(from, x);
  Activate(Activation::kTanh, x);
}

}  // namespace tactus::examples
