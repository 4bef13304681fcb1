#include "tests/reference/lstm/gradient.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

absl::StatusOr<LstmGradient> LossAndGradient(
    const LstmNetwork& network, std::span<const LstmSequence> batch,
    const LstmLossOptions& options, const LstmNoise& noise, uint64_t seed) {
  TACTUS_RETURN_IF_ERROR(Validate(network));
  TACTUS_RETURN_IF_ERROR(Validate(batch, network));
  TACTUS_RETURN_IF_ERROR(Validate(options));
  TACTUS_RETURN_IF_ERROR(Validate(noise));
  if (batch.empty()) return InvalidTrainingData("no sequences");
  LstmBackprop backprop(network);
  backprop.SetWeights(network);
  Random random(seed);
  backprop.Forward(batch, noise, random);
  LstmGradient result;
  result.loss = backprop.Loss(options).sum / static_cast<double>(batch.size());
  result.gradient = network;
  backprop.Backward(result.gradient);
  return result;
}

}  // namespace tactus::internal
