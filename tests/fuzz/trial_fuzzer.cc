// Gives arbitrary bytes to a TrialSession, with and without a good config in
// front. Each trial must end, with a final answer or with a reason.
#include <fuzzer/FuzzedDataProvider.h>

#include "core/base/errors.h"
#include "server/session/trial_session.h"
#include "tests/server/support/test_models.h"

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

namespace {

std::string ConfigBytes() {
  tactus::v1::ClassifyTrialRequest request;
  request.mutable_config()->mutable_geometry()->set_layout("cody-forearm");
  request.mutable_config()->set_taxel_type(tactus::v1::TAXEL_TYPE_UINT16);
  return request.SerializeAsString();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const models = new tactus::internal::testing::TestModels();
  FuzzedDataProvider data(bytes, size);
  std::string request = data.ConsumeBool() ? ConfigBytes() : "";
  request += data.ConsumeRemainingBytesAsString();
  const size_t most_steps = request.size() + 2;
  tactus::internal::server::TrialSession trial(models, {}, std::move(request));
  tactus::v1::ClassifyContactRequest parsed;
  for (size_t steps = 0; !trial.done(); ++steps) {
    REQUIRE(steps < most_steps);
    trial.Step(&parsed);
  }
  if (trial.status().ok()) {
    REQUIRE(trial.response().answer().is_final());
  } else {
    REQUIRE(!tactus::internal::ReasonOf(trial.status()).empty());
  }
  return 0;
}
