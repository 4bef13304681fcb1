#include "core/lstm/network.h"

#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"
#include "core/lstm/stepper.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

LstmNetwork PaperNetwork(int inputs = 2, uint64_t seed = 1) {
  return RandomNetwork(inputs, {50, 50}, 4, Activation::kSoftsign,
                       GateActivation::kHardSigmoid, seed);
}

TEST(LstmNetworkTest, PaperNetworkHas31004Parameters) {
  EXPECT_EQ(PaperNetwork().parameter_count(), 31'004);
  EXPECT_EQ(PaperNetwork(3).parameter_count(), 31'204);
  EXPECT_EQ(PaperNetwork().inputs(), 2);
  EXPECT_EQ(PaperNetwork().classes(), 4);
}

TEST(LstmNetworkTest, RegressionsTakeTwoRowsEachAndNoClass) {
  const LstmNetwork network =
      RandomNetwork(3, {50, 50}, 4, Activation::kTanh, GateActivation::kSigmoid,
                    1, /*forget_bias=*/1, /*regressions=*/2);
  EXPECT_TRUE(Validate(network).ok());
  EXPECT_EQ(network.classes(), 4);
  EXPECT_EQ(network.parameter_count(), 31'204 + 4 * 51);
}

TEST(LstmNetworkTest, RandomNetworkIsValidAndItsSeedFixesIt) {
  EXPECT_TRUE(Validate(PaperNetwork()).ok());
  EXPECT_EQ(PaperNetwork().layers[1].kernel, PaperNetwork().layers[1].kernel);
  EXPECT_NE(PaperNetwork(2, 1).dense_kernel, PaperNetwork(2, 2).dense_kernel);
}

TEST(LstmNetworkTest, RandomWeightsFillTheirUniformLimits) {
  const LstmLayer layer = PaperNetwork().layers[1];
  // Glorot: sqrt(6 / (50 + 50)); the variance of a uniform is limit^2 / 3.
  const double limit = std::sqrt(6.0 / 100);
  double squares = 0;
  for (float weight : layer.kernel) {
    EXPECT_LE(std::abs(weight), limit);
    squares += weight * weight;
  }
  EXPECT_NEAR(squares / layer.kernel.size(), limit * limit / 3, 1e-3);
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(layer.bias[i], i >= 50 && i < 100 ? 1 : 0);
  }
}

TEST(LstmNetworkTest, EachFaultIsRefusedByName) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  struct Case {
    const char* field;
    void (*spoil)(LstmNetwork&);
  };
  const Case cases[] = {
      {"lstm.layers", [](LstmNetwork& n) { n.layers.clear(); }},
      {"lstm.layers",
       [](LstmNetwork& n) { n.layers.resize(9, n.layers.back()); }},
      {"lstm.layers[0].inputs", [](LstmNetwork& n) { n.layers[0].inputs = 0; }},
      {"lstm.layers[0].inputs",
       [](LstmNetwork& n) { n.layers[0].inputs = -1; }},
      {"lstm.layers[1].cells", [](LstmNetwork& n) { n.layers[1].cells = 0; }},
      {"lstm.layers[1].cells",
       [](LstmNetwork& n) {
         n.layers[1].cells = std::numeric_limits<int>::max();
       }},
      {"lstm.layers[1].inputs",
       [](LstmNetwork& n) { n.layers[1] = n.layers[0]; }},
      {"lstm.layers[0].kernel size",
       [](LstmNetwork& n) { n.layers[0].kernel.pop_back(); }},
      {"lstm.layers[0].recurrent size",
       [](LstmNetwork& n) { n.layers[0].recurrent.push_back(0); }},
      {"lstm.layers[1].bias size",
       [](LstmNetwork& n) { n.layers[1].bias.clear(); }},
      {"lstm.layers[0].kernel[3]",
       [](LstmNetwork& n) { n.layers[0].kernel[3] = kNan; }},
      {"lstm.layers[0].recurrent[0]",
       [](LstmNetwork& n) { n.layers[0].recurrent[0] = -kInfinity; }},
      {"lstm.layers[1].bias[199]",
       [](LstmNetwork& n) { n.layers[1].bias[199] = 2e6F; }},
      {"lstm.dense_bias size", [](LstmNetwork& n) { n.dense_bias.clear(); }},
      {"lstm.dense_bias size", [](LstmNetwork& n) { n.dense_bias.resize(65); }},
      {"lstm.dense_bias size", [](LstmNetwork& n) { n.regressions = 2; }},
      {"lstm.regressions", [](LstmNetwork& n) { n.regressions = -1; }},
      {"lstm.regressions",
       [](LstmNetwork& n) { n.regressions = std::numeric_limits<int>::max(); }},
      {"lstm.hidden[0].inputs",
       [](LstmNetwork& n) {
         n.hidden = {{49, 1, {}, {}, {}}};
       }},
      {"lstm.hidden[0].units",
       [](LstmNetwork& n) {
         n.hidden = {{50, 0, {}, {}, {}}};
       }},
      {"lstm.hidden[0].kernel size",
       [](LstmNetwork& n) {
         n.hidden = {{50, 2, {}, {1}, {0, 0}}};
       }},
      {"lstm.hidden[0].bias size",
       [](LstmNetwork& n) {
         n.hidden = {{50, 1, {}, std::vector<float>(50), {}}};
       }},
      {"lstm.hidden",
       [](LstmNetwork& n) {
         n.hidden.resize(9, {50, 1, {}, std::vector<float>(50), {0}});
       }},
      {"lstm.dense_kernel size",
       [](LstmNetwork& n) {
         n.hidden = {{50, 1, {}, std::vector<float>(50), {0}}};
       }},
      {"lstm.dense_bias[2]", [](LstmNetwork& n) { n.dense_bias[2] = kNan; }},
      {"lstm.dense_kernel size",
       [](LstmNetwork& n) { n.dense_kernel.resize(4 * 49); }},
      {"lstm.dense_kernel[7]",
       [](LstmNetwork& n) { n.dense_kernel[7] = kInfinity; }},
  };
  for (const Case& c : cases) {
    LstmNetwork network = PaperNetwork();
    c.spoil(network);
    const absl::Status status = Validate(network);
    EXPECT_EQ(ReasonOf(status), "INVALID_MODEL") << c.field;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.field);
    EXPECT_EQ(CompiledLstm::Create(network).status().message(),
              status.message());
  }
}

}  // namespace
}  // namespace tactus::internal
