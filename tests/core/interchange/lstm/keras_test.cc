// Keras files: what is refused, and damage. recorded_answers_test.cc compares
// posteriors.
#include <hdf5.h>

#include <filesystem>

#include "core/base/errors.h"
#include "core/files/hdf5_handle.h"
#include "core/interchange/lstm/keras_config.h"
#include "core/interchange/read_model_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/core/interchange/golden.h"

// libhdf5 does not free all that it read of a damaged file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

namespace tactus::internal {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(KerasTest, AFileOfWeightsTakesTheGivenActivations) {
  const auto foreign =
      ReadModelFile(GoldenPath("keras2-weights.h5"),
                    {Activation::kSoftsign, GateActivation::kHardSigmoid});
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  EXPECT_EQ(foreign->lstms[0].activation, Activation::kSoftsign);
  EXPECT_EQ(foreign->lstms[0].gate_activation, GateActivation::kHardSigmoid);
}

TEST(KerasTest, AFileOfAModelStatesItsActivations) {
  const auto foreign = ReadModelFile(GoldenPath("keras2-model.h5"), {});
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  EXPECT_EQ(foreign->lstms[0].activation, Activation::kSoftsign);
  EXPECT_EQ(foreign->lstms[0].gate_activation, GateActivation::kHardSigmoid);
}

struct BadFile {
  const char* text;
  // Changes an open copy of `file`.
  void (*change)(hid_t file);
  const char* file = "keras2-weights.h5";
};

class BadKerasFileTest : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadKerasFileTest, IsRefusedByName) {
  const ScratchDir dir;
  const std::string path = dir / "net.h5";
  WriteBytes(path, Golden(GetParam().file));
  {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                          H5Fclose);
    ASSERT_TRUE(file.ok());
    GetParam().change(file.get());
  }
  const auto foreign = ReadModelFile(path);
  EXPECT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL") << foreign.status();
  EXPECT_THAT(std::string(foreign.status().message()), HasSubstr("net.h5: "));
  EXPECT_THAT(std::string(foreign.status().message()),
              HasSubstr(GetParam().text));
}

constexpr char kKernel[] = "lstm/lstm/lstm_cell/kernel:0";
constexpr char kRecurrent[] = "lstm/lstm/lstm_cell/recurrent_kernel:0";
constexpr char kBias[] = "lstm/lstm/lstm_cell/bias:0";

void Write(hid_t file, const char* name, std::vector<hsize_t> dims) {
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) {
    H5Ldelete(file, name, H5P_DEFAULT);
  }
  const Hdf5Handle space(
      H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
      H5Sclose);
  hsize_t count = 1;
  for (const hsize_t size : dims) count *= size;
  const std::vector<float> zeros(count);
  const Hdf5Handle dataset(H5Dcreate2(file, name, H5T_IEEE_F32LE, space.get(),
                                      H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose);
  H5Dwrite(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT,
           zeros.data());
}

// An attribute with texts of 32 bytes.
void WriteNames(hid_t group, const char* name,
                const std::vector<std::string>& texts) {
  constexpr size_t kBytes = 32;
  std::string bytes;
  for (std::string text : texts) {
    text.resize(kBytes);
    bytes += text;
  }
  const hsize_t count = texts.size();
  const Hdf5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), kBytes);
  const Hdf5Handle attribute(H5Acreate2(group, name, type.get(), space.get(),
                                        H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  H5Awrite(attribute.get(), type.get(), bytes.data());
}

INSTANTIATE_TEST_SUITE_P(
    All, BadKerasFileTest,
    ::testing::Values(
        BadFile{"this is no model of Keras",
                [](hid_t f) { H5Adelete(f, "layer_names"); }},
        BadFile{"lstm/lstm_cell/kernel:0: is missing",
                [](hid_t f) { H5Ldelete(f, kKernel, H5P_DEFAULT); }},
        BadFile{"link to another place",
                [](hid_t f) {
                  H5Ldelete(f, kKernel, H5P_DEFAULT);
                  H5Lcreate_soft("/dense/dense/kernel:0", f, kKernel,
                                 H5P_DEFAULT, H5P_DEFAULT);
                }},
        BadFile{"link to another place",
                [](hid_t f) {
                  H5Ldelete(f, "lstm", H5P_DEFAULT);
                  H5Lcreate_external("other.h5", "/lstm", f, "lstm",
                                     H5P_DEFAULT, H5P_DEFAULT);
                }},
        // A GRU has three gates, SimpleRNN one.
        BadFile{"layer lstm is a layer with bias (24, 0), kernel (3, 18)",
                [](hid_t f) {
                  Write(f, kKernel, {3, 18});
                  Write(f, kRecurrent, {6, 18});
                }},
        BadFile{"recurrent_kernel (6, 18)",
                [](hid_t f) {
                  Write(f, kRecurrent, {6, 18});
                }},
        BadFile{"bias (23, 0)", [](hid_t f) { Write(f, kBias, {23}); }},
        BadFile{"has 3 axes",
                [](hid_t f) {
                  Write(f, kKernel, {3, 4, 6});
                }},
        BadFile{"layers[1].inputs is 6",
                [](hid_t f) {
                  Write(f, kKernel, {3, 20});
                  Write(f, kRecurrent, {5, 20});
                  Write(f, kBias, {20});
                }},
        // A Bidirectional layer has the weights of two LSTMs.
        BadFile{"layer lstm: has two arrays kernel",
                [](hid_t f) {
                  const Hdf5Handle group(H5Gopen2(f, "lstm", H5P_DEFAULT),
                                         H5Gclose);
                  H5Adelete(group.get(), "weight_names");
                  WriteNames(
                      group.get(), "weight_names",
                      {"lstm/lstm_cell/kernel:0", "lstm/lstm_cell/kernel:0"});
                }},
        BadFile{"layer lstm_1: has a part forward_layer",
                [](hid_t f) {
                  const Hdf5Handle group(
                      H5Gcreate2(f, "layers/lstm_1/forward_layer", H5P_DEFAULT,
                                 H5P_DEFAULT, H5P_DEFAULT),
                      H5Gclose);
                },
                "keras3.weights.h5"},
        BadFile{"layer dense: has 4 arrays",
                [](hid_t f) {
                  Write(f, "layers/dense/vars/2", {4});
                  Write(f, "layers/dense/vars/3", {4});
                },
                "keras3.weights.h5"},
        BadFile{"must be text", [](hid_t f) {
                  H5Adelete(f, "layer_names");
                  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
                  const Hdf5Handle attribute(
                      H5Acreate2(f, "layer_names", H5T_IEEE_F32LE, space.get(),
                                 H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
                }}));

TEST(KerasTest, DamageIsRefusedOrGivesAValidNetwork) {
  const ScratchDir dir;
  const std::string path = dir / "net.h5";
  Random random(9);
  const auto check = [&](const std::string& bytes) {
    WriteBytes(path, bytes);
    const auto foreign = ReadModelFile(path);
    if (foreign.ok()) {
      ASSERT_TRUE(Validate(foreign->lstms[0]).ok());
      return;
    }
    ASSERT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL") << foreign.status();
    ASSERT_THAT(std::string(foreign.status().message()), HasSubstr("net.h5: "));
  };
  for (const char* name : {"keras2-weights.h5", "keras3.weights.h5"}) {
    const std::string good = Golden(name);
    for (size_t length = 0; length < good.size(); length += 997) {
      check(good.substr(0, length));
    }
    for (int i = 0; i < 150; ++i) {
      std::string bad = good;
      for (int k = 0; k < 3; ++k) {
        bad[random.Index(bad.size())] ^=
            static_cast<char>(1 << random.Index(8));
      }
      check(bad);
    }
  }
}

json Config(const char* type, json config) {
  config["name"] = "x";
  return {
      {"class_name", "Sequential"},
      {"config", {{"layers", {{{"class_name", type}, {"config", config}}}}}}};
}

TEST(KerasConfigTest, EachUnsupportedLayerIsNamed) {
  struct Case {
    json config;
    int version;
    const char* text;
  };
  const Case cases[] = {
      {Config("GRU", {}), 2, "layer x is GRU"},
      {Config("Bidirectional", {}), 2, "layer x is Bidirectional"},
      {Config("LayerNormalization", {}), 2, "layer x is LayerNormalization"},
      {Config("BatchNormalization", {{"axis", 1}}), 2, "layer x axis is 1"},
      {Config("Activation", {{"activation", "selu"}}), 2, "activation is selu"},
      {Config("ReLU", {{"max_value", 6}}), 2, "layer x max_value is 6"},
      // A function that is no text must not be taken for the default.
      {Config("LSTM", {{"activation", nullptr}}), 2, "activation is no text"},
      {{{"class_name", "Functional"},
        {"config",
         {{"layers", json::array()},
          {"output_layers", {{"a", 0, 0}, {"b", 0, 0}}}}}},
       2,
       "output_layers is 2"},
      {Config("TimeDistributed", {}), 2, "layer x is TimeDistributed"},
      {Config("TimeDistributed", {{"layer", {{"class_name", "Conv1D"}}}}), 2,
       "layer x is TimeDistributed of Conv1D"},
      {Config("Bidirectional", {{"layer", {{"class_name", "LSTM"}}}}), 3,
       "layer x is Bidirectional of LSTM"},
      {Config("Embedding", {}), 3, "layer x is Embedding"},
      {Config("LSTM", {{"return_state", true}}), 3, "return_state is true"},
      // Layers that are used twice are no chain.
      {{{"class_name", "Functional"},
        {"config",
         {{"layers",
           {{{"class_name", "Dense"},
             {"name", "d"},
             {"config", {{"name", "d"}}},
             {"inbound_nodes", {json::object(), json::object()}}}}}}}},
       3,
       "layer d uses is 2"},
      {Config("Dense", {{"activation", "elu"}}), 2, "activation is elu"},
      {Config("LSTM", {{"activation", "relu"}}), 2, "activation is relu"},
      {Config("LSTM", {{"go_backwards", true}}), 2, "go_backwards is true"},
      {Config("LSTM", {{"recurrent_activation", "tanh"}}), 2,
       "recurrent_activation is tanh"},
      // Another function in Keras 3.
      {Config("LSTM", {{"recurrent_activation", "hard_sigmoid"}}), 3,
       "recurrent_activation is hard_sigmoid"},
      {json::object(), 2, "of another form"},
      {json::array(), 2, "of another form"},
      {{{"class_name", "Custom"}, {"config", {}}}, 2, "class_name is Custom"},
      {{{"class_name", "Model"}, {"config", {{"layers", 3}}}},
       2,
       "of another form"},
  };
  for (const Case& c : cases) {
    const auto config = ParseKerasConfig(c.config.dump(), c.version);
    EXPECT_EQ(ReasonOf(config.status()), "INVALID_MODEL");
    EXPECT_THAT(std::string(config.status().message()), HasSubstr(c.text));
  }
}

// Which activation hidden layers have is not to be guessed.
TEST(KerasTest, HiddenLayersOfWeightsAloneNeedTheirActivation) {
  const std::string path = GoldenPath("stack-weights.h5");
  const absl::Status status = ReadModelFile(path).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_MODEL");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("activation of the hidden layer dense is not known"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("--dense-activation"));
  const auto foreign =
      ReadModelFile(path, {.dense_activation = HiddenActivation::kRelu});
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  EXPECT_EQ(foreign->lstms[0].hidden.size(), 1u);
}

TEST(ReadModelFileTest, PicklesAndUnknownEndingsAreRefusedByName) {
  for (const char* name :
       {"hmm.pkl", "hmm.PICKLE", "hmm.joblib", "net.pt", "net.pth"}) {
    const auto foreign = ReadModelFile(name);
    EXPECT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
    EXPECT_THAT(std::string(foreign.status().message()),
                HasSubstr(std::string(name) + ": is a pickle"));
  }
  EXPECT_THAT(std::string(ReadModelFile("net.keras").status().message()),
              HasSubstr("model.save(\"x.h5\")"));
  EXPECT_THAT(std::string(ReadModelFile("net.bin").status().message()),
              HasSubstr("no known ending"));
  EXPECT_EQ(ReasonOf(ReadModelFile("/nowhere/net.onnx").status()), "IO");
  EXPECT_EQ(ReasonOf(ReadModelFile("/nowhere/net.h5").status()), "IO");
}

}  // namespace
}  // namespace tactus::internal
