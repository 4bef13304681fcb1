#include "core/classify/compiled_model.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/classify/contact_classifier.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

TEST(CompiledModelTest, EachInconsistencyIsRefused) {
  EXPECT_TRUE(CompiledModel::Create(testing::SmallModel()).ok());
  using Spoil = void (*)(Model&);
  const Spoil spoils[] = {
      [](Model& m) { m.class_names = {"HU"}; },
      [](Model& m) { m.class_names[1] = "HU"; },
      [](Model& m) { m.class_names[1] = ""; },
      [](Model& m) { m.hmms.pop_back(); },
      [](Model& m) { m.hmms[2].components.clear(); },
      [](Model& m) { m.hmms[2].components[0].transition[0] = 0.5; },
      [](Model& m) { m.hmms[2].components[0].covariances[0] = -1; },
      [](Model& m) { m.inputs.hmm.pop_back(); },
      [](Model& m) { m.calibration.prior = {1}; },
      [](Model& m) {
        m.warm_up.samples = {{{1, 1, 1}, 1}};
      },
      [](Model& m) {
        m.warm_up.probability = m.warm_up.log_likelihood = {0, 0, 0, 0};
        m.warm_up.samples = {{{1, 1, 1}, 1, {std::nan("")}}};
      },
      [](Model& m) { m.layout.name = "half a layout"; },
      [](Model& m) {
        m.lstms = {RandomNetwork(3, {4}, 4, Activation::kTanh,
                                 GateActivation::kSigmoid, 1)};
        m.inputs.lstm = m.inputs.hmm;
        testing::AddLstmCalibration(m.calibration);
      },
  };
  for (size_t i = 0; i < std::size(spoils); ++i) {
    Model model = testing::SmallModel();
    spoils[i](model);
    const auto compiled = CompiledModel::Create(std::move(model));
    EXPECT_FALSE(compiled.ok()) << i;
    EXPECT_FALSE(ReasonOf(compiled.status()).empty()) << i;
  }
}

TEST(RunWarmUpTest, PassesForItsAnswerAndFailsForAnother) {
  Model model = testing::SmallModel();
  model.warm_up.samples.assign(20, {{2.0, 0.0, 0.001}, 2.0});
  model.warm_up.probability.assign(4, 0);
  model.warm_up.log_likelihood.assign(4, 0);
  {
    auto compiled = *CompiledModel::Create(model);
    ContactClassifier classifier(compiled, {});
    for (const auto& frame : model.warm_up.samples) classifier.Step(frame, 0);
    const auto p = classifier.probability();
    model.warm_up.probability.assign(p.begin(), p.end());
  }
  EXPECT_TRUE(RunWarmUp(**CompiledModel::Create(model)).ok());
  model.warm_up.probability[0] += 1e-3;
  EXPECT_EQ(ReasonOf(RunWarmUp(**CompiledModel::Create(model))),
            "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
