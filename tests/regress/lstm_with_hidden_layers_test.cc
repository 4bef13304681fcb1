// None of four public LSTM classifiers could be imported: they had hidden Dense
// layers with relu, dropout and batch normalization. numpy_stacks.py wrote
// these files, and what numpy computes.
#include "core/interchange/read_model_file.h"
#include "core/interchange/replace_models.h"
#include "gtest/gtest.h"
#include "tests/core/interchange/golden.h"
#include "tests/core/interchange/peer_answers.h"

namespace tactus::internal {
namespace {

TEST(LstmWithHiddenLayersTest, GoesIntoAModelAndAnswersAsItsProgram) {
  for (const PeerAnswer& answer : ReadPeerAnswers(GoldenPath("stacks.json"))) {
    const auto foreign = ReadModelFile(
        GoldenPath(answer.file), {.dense_activation = HiddenActivation::kRelu});
    ASSERT_TRUE(foreign.ok()) << foreign.status();
    const LstmNetwork& network = foreign->lstms[0];
    EXPECT_FALSE(network.hidden.empty()) << answer.file;
    EXPECT_LE(Difference(foreign->lstms, answer), 1e-5) << answer.file;
    if (network.classes() != 4) continue;
    Model model =
        ModelOf({MakeNetwork(network.inputs(), {3}, 4, Activation::kTanh,
                             GateActivation::kSigmoid, 1)});
    ASSERT_TRUE(ReplaceModels(*foreign, model).ok()) << answer.file;
    EXPECT_EQ(model.lstms[0].hidden.size(), network.hidden.size());
  }
}

// The classes of a file are put into the model's order, hidden layers or not.
TEST(LstmWithHiddenLayersTest, ItsClassesAreReordered) {
  auto foreign = ReadModelFile(GoldenPath("stack-keras2.h5"));
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  const Rows inputs = MakeInputs(3, 20, 2);
  const Rows before = Posteriors(foreign->lstms, inputs);
  Model model = ModelOf(
      {MakeNetwork(3, {3}, 4, Activation::kTanh, GateActivation::kSigmoid, 1)});
  foreign->class_names = {"SM", "HU", "HM", "SU"};
  ASSERT_TRUE(ReplaceModels(*foreign, model).ok());
  const Rows after = Posteriors(model.lstms, inputs);
  for (size_t t = 0; t < inputs.size(); ++t) {
    EXPECT_NEAR(after[t][0], before[t][1], 1e-12);
    EXPECT_NEAR(after[t][3], before[t][0], 1e-12);
  }
}

}  // namespace
}  // namespace tactus::internal
