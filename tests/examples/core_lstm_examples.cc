// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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

namespace tactus::internal::examples {

void Use(std::span<const double> probability);

static void BackpropExample(const LstmNetwork& network,
                            std::span<const LstmSequence> batch, Random& random,
                            const LstmLossOptions& options,
                            LstmNetwork& gradient) {
#include "core/lstm/backprop.h.inc"
}

static void BatchLayoutExample() {
#include "core/lstm/batch_layout.h.inc"
}

static absl::Status NoiseExample(const LstmNoise& noise, Random& random,
                                 std::span<float> mask,
                                 std::span<float> inputs) {
#include "core/lstm/noise.h.inc"
  return absl::OkStatus();
}

static void SequenceSourceExample(LstmSequenceSource& source) {
#include "core/lstm/sequence_source.h.inc"
}

static void KernelsExample(const float* input, const float* weights) {
#include "core/lstm/kernels.h.inc"
}

static void LossExample(const LstmLossOptions& options, const float* outputs,
                        int label, int steps, float* gradient) {
  double loss = 0;
#include "core/lstm/loss.h.inc"
}

static absl::Status NetworkExample(uint64_t seed) {
#include "core/lstm/network.h.inc"
  return absl::OkStatus();
}

static void OptimizerExample(const OptimizerOptions& options,
                             LstmNetwork& gradient, LstmNetwork& network) {
#include "core/lstm/optimizer.h.inc"
}

static void PackedMatrixExample(const LstmLayer& layer) {
#include "core/lstm/packed_matrix.h.inc"
}

static void SequenceExample(std::span<const float> frames) {
#include "core/lstm/sequence.h.inc"
}

static absl::Status StepperExample(
    const LstmNetwork& network,
    const std::vector<std::vector<double>>& scaled_features) {
#include "core/lstm/stepper.h.inc"
  return absl::OkStatus();
}

static absl::Status TrainExample(const LstmNetwork& network,
                                 std::span<const LstmSequence> training,
                                 std::span<const LstmSequence> validation) {
#include "core/lstm/train.h.inc"
  return absl::OkStatus();
}

static void VectorMathExample(const float* from) {
#include "core/lstm/vector_math.h.inc"
}

}  // namespace tactus::internal::examples
