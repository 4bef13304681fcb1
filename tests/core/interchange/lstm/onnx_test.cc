// LSTMs to ONNX and back, and what is refused.
#include "core/base/errors.h"
#include "core/interchange/lstm/lstm_from_onnx.h"
#include "core/interchange/lstm/lstm_to_onnx.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/interchange/golden.h"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<ForeignModel> Read(const onnx::ModelProto& model) {
  return LstmsFromOnnx("x.onnx", model.SerializeAsString());
}

onnx::ModelProto Parse(const std::string& bytes) {
  onnx::ModelProto model;
  EXPECT_TRUE(model.ParseFromString(bytes));
  return model;
}

TEST(OnnxTest, WhatIsExportedIsReadBitForBit) {
  for (const NetworkSample& sample : NetworkSamples()) {
    for (const OnnxGraph graph : {OnnxGraph::kSequence, OnnxGraph::kStep}) {
      const auto foreign =
          LstmsFromOnnx("x.onnx", *LstmsToOnnx(sample.model, graph));
      ASSERT_TRUE(foreign.ok()) << sample.name << foreign.status();
      ASSERT_EQ(foreign->lstms.size(), sample.model.lstms.size());
      for (size_t n = 0; n < foreign->lstms.size(); ++n) {
        const LstmNetwork& got = foreign->lstms[n];
        const LstmNetwork& want = sample.model.lstms[n];
        EXPECT_EQ(got.activation, want.activation);
        EXPECT_EQ(got.gate_activation, want.gate_activation);
        EXPECT_EQ(got.dense_kernel, want.dense_kernel);
        EXPECT_EQ(got.dense_bias, want.dense_bias);
        ASSERT_EQ(got.layers.size(), want.layers.size());
        for (size_t l = 0; l < got.layers.size(); ++l) {
          EXPECT_EQ(got.layers[l].kernel, want.layers[l].kernel);
          EXPECT_EQ(got.layers[l].recurrent, want.layers[l].recurrent);
          EXPECT_EQ(got.layers[l].bias, want.layers[l].bias);
        }
      }
      EXPECT_THAT(foreign->class_names, ElementsAre("HU", "HM", "SU", "SM"));
      EXPECT_EQ(foreign->sample_rate_hz, 100);
      ASSERT_TRUE(foreign->steps.has_value());
      EXPECT_EQ(foreign->steps->min, 5u);
      EXPECT_EQ(foreign->steps->max, 20u);
      ASSERT_EQ(foreign->inputs.size(), sample.model.inputs.lstm.size());
      for (size_t i = 0; i < foreign->inputs.size(); ++i) {
        const ModelInput& input = sample.model.inputs.lstm[i];
        EXPECT_EQ(foreign->inputs[i].offset, input.offset);
        EXPECT_EQ(foreign->inputs[i].gain, input.gain);
        EXPECT_EQ(foreign->inputs[i].limit, input.limit);
      }
    }
  }
}

TEST(OnnxTest, AModelWithoutLstmsIsRefused) {
  EXPECT_EQ(
      ReasonOf(LstmsToOnnx(testing::SmallModel(), OnnxGraph::kStep).status()),
      "INVALID_MODEL");
}

struct BadOnnx {
  const char* text;
  // Changes a good model of one network, opset 11: nodes LSTM, Squeeze,
  // MatMul, Add, Softmax.
  void (*change)(onnx::ModelProto&);
};

class BadOnnxTest : public ::testing::TestWithParam<BadOnnx> {};

onnx::AttributeProto& NewAttribute(onnx::ModelProto& model, int node,
                                   const char* name) {
  onnx::AttributeProto* attribute =
      model.mutable_graph()->mutable_node(node)->add_attribute();
  attribute->set_name(name);
  return *attribute;
}

// Puts `type` between the output of node `index` and what follows.
onnx::NodeProto& Insert(onnx::ModelProto& model, int index, const char* type) {
  onnx::GraphProto& graph = *model.mutable_graph();
  onnx::NodeProto* added = graph.add_node();
  added->set_op_type(type);
  added->set_name("inserted");
  added->add_input("before");
  added->add_output(graph.node(index).output(0));
  graph.mutable_node(index)->set_output(0, "before");
  for (int i = graph.node_size() - 1; i > index + 1; --i) {
    graph.mutable_node()->SwapElements(i, i - 1);
  }
  return *graph.mutable_node(index + 1);
}

TEST_P(BadOnnxTest, IsRefusedByName) {
  onnx::ModelProto model = Parse(Golden("tanh-sigmoid-sequence.onnx"));
  ASSERT_TRUE(Read(model).ok());
  GetParam().change(model);
  const auto foreign = Read(model);
  EXPECT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
  EXPECT_THAT(std::string(foreign.status().message()), HasSubstr("x.onnx: "));
  EXPECT_THAT(std::string(foreign.status().message()),
              HasSubstr(GetParam().text));
}

constexpr int kLstm = 0;
constexpr int kMatMul = 2;
constexpr int kAdd = 3;
constexpr int kSoftmax = 4;

INSTANTIATE_TEST_SUITE_P(
    All, BadOnnxTest,
    ::
        testing::Values(BadOnnx{"opset is 6",
                                [](onnx::ModelProto& m) {
                                  m.mutable_opset_import(0)->set_version(6);
                                }},
                        BadOnnx{"opset is absent",
                                [](onnx::ModelProto& m) {
                                  m.clear_opset_import();
                                }},
                        BadOnnx{"node 0 \"lstm0_0_Y\" (GRU) is not "
                                "supported",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_node(kLstm)
                                      ->set_op_type("GRU");
                                }},
                        BadOnnx{"(LeakyRelu) is not supported",
                                [](onnx::ModelProto& m) {
                                  Insert(m, kAdd, "LeakyRelu");
                                }},
                        BadOnnx{
                            "(BatchNormalization) must have the features as "
                            "axis 1",
                            [](onnx::ModelProto& m) {
                              Insert(m, kLstm, "BatchNormalization");
                            }},
                        BadOnnx{"has the direction \"bidirectional\"",
                                [](onnx::ModelProto& m) {
                                  NewAttribute(m, kLstm, "direction")
                                      .set_s("bidirectional");
                                }},
                        BadOnnx{"has the attribute clip",
                                [](onnx::ModelProto& m) {
                                  NewAttribute(m, kLstm, "clip").set_f(3);
                                }},
                        BadOnnx{
                            "couples input and forget gate",
                            [](onnx::ModelProto& m) {
                              NewAttribute(m, kLstm, "input_forget").set_i(1);
                            }},
                        BadOnnx{"has the activations \"Sigmoid, "
                                "Relu, Tanh\"",
                                [](onnx::ModelProto& m) {
                                  auto& names =
                                      NewAttribute(m, kLstm, "activations");
                                  names.add_strings("Sigmoid");
                                  names.add_strings("Relu");
                                  names.add_strings("Tanh");
                                }},
                        BadOnnx{"HardSigmoid",
                                [](onnx::ModelProto& m) {
                                  auto& names =
                                      NewAttribute(m, kLstm, "activations");
                                  names.add_strings("HardSigmoid");
                                  names.add_strings("Tanh");
                                  names.add_strings("Tanh");
                                  NewAttribute(m, kLstm, "activation_alpha")
                                      .add_floats(1 / 6.0F);
                                }},
                        BadOnnx{"has hidden_size 9",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_node(kLstm)
                                      ->mutable_attribute(0)
                                      ->set_i(9);
                                }},
                        BadOnnx{"has peepholes",
                                [](onnx::ModelProto& m) {
                                  auto* node =
                                      m.mutable_graph()->mutable_node(kLstm);
                                  for (const char* name :
                                       {"", "", "", "lstm0_0_W"}) {
                                    node->add_input(name);
                                  }
                                }},
                        BadOnnx{
                            "has lengths of sequences",
                            [](onnx::ModelProto& m) {
                              m.mutable_graph()->mutable_node(kLstm)->add_input(
                                  "lstm0_0_W");
                            }},
                        BadOnnx{"starts from a state that is not zero",
                                [](onnx::ModelProto& m) {
                                  auto* node =
                                      m.mutable_graph()->mutable_node(kLstm);
                                  node->add_input("");
                                  node->add_input("lstm0_0_W");
                                }},
                        BadOnnx{"uses \"nowhere\", which nothing "
                                "before it makes",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_node(kMatMul)
                                      ->set_input(0, "nowhere");
                                }},
                        BadOnnx{"in another file",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_initializer(0)
                                      ->set_data_location(1);
                                }},
                        BadOnnx{"type is 10",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_initializer(0)
                                      ->set_data_type(10);
                                }},
                        BadOnnx{"cut short or too long",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_initializer(0)
                                      ->mutable_raw_data()
                                      ->pop_back();
                                }},
                        BadOnnx{"numbers in all",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_initializer(0)
                                      ->set_dims(0, int64_t{1} << 40);
                                }},
                        BadOnnx{
                            "has W of shape (1, 28, 2); it must be (1, 8, 2)",
                            [](onnx::ModelProto& m) {
                              auto* node =
                                  m.mutable_graph()->mutable_node(kLstm);
                              node->set_input(2, node->input(1));
                              m.mutable_graph()
                                  ->mutable_initializer(0)
                                  ->set_dims(2, 2);
                            }},
                        BadOnnx{"has no weights of 4 features",
                                [](onnx::ModelProto& m) {
                                  auto& node = Insert(m, kAdd, "MatMul");
                                  node.add_input("lstm0_dense_kernel");
                                }},
                        BadOnnx{"must have one number, or one per feature",
                                [](onnx::ModelProto& m) {
                                  auto& node = Insert(m, kLstm, "Mul");
                                  node.add_input("lstm0_dense_bias");
                                }},
                        BadOnnx{"must have a single number as factor",
                                [](onnx::ModelProto& m) {
                                  auto& node = Insert(m, kSoftmax, "Mul");
                                  node.add_input("lstm0_dense_bias");
                                }},
                        BadOnnx{"may only add probabilities of "
                                "networks",
                                [](onnx::ModelProto& m) {
                                  auto& node = Insert(m, kAdd, "Add");
                                  node.add_input("before");
                                }},
                        BadOnnx{"factor on the sum of networks is 1",
                                [](onnx::ModelProto& m) {
                                  auto& node = Insert(m, kSoftmax, "Add");
                                  node.add_input("before");
                                }},
                        BadOnnx{"removes the axis of time or of "
                                "features",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_node(1)
                                      ->mutable_attribute(0)
                                      ->set_ints(0, 0);
                                }},
                        BadOnnx{"run over its classes",
                                [](onnx::ModelProto& m) {
                                  m.mutable_graph()
                                      ->mutable_node(kSoftmax)
                                      ->mutable_attribute(0)
                                      ->set_i(0);
                                }},
                        BadOnnx{
                            "has a perm that is no permutation",
                            [](onnx::ModelProto& m) {
                              auto* perm =
                                  Insert(m, kAdd, "Transpose").add_attribute();
                              perm->set_name("perm");
                              for (int i = 0; i < 3; ++i) perm->add_ints(1);
                            }},
                        BadOnnx{"takes entry 0 of the frames",
                                [](onnx::ModelProto& m) {
                                  auto* index =
                                      m.mutable_graph()->add_initializer();
                                  index->set_name("index");
                                  index->set_data_type(7);
                                  index->add_int64_data(0);
                                  Insert(m, kAdd, "Gather").add_input("index");
                                }},
                        BadOnnx{
                            "graph output is not a linear layer",
                            [](onnx::ModelProto& m) {
                              m.mutable_graph()->mutable_output(0)->set_name(
                                  "lstm0_0_Y");
                            }},
                        BadOnnx{"graph output is there several times",
                                [](onnx::ModelProto& m) {
                                  *m.mutable_graph()->add_output() =
                                      m.graph().output(0);
                                }},
                        BadOnnx{"tactus.class_names is 1",
                                [](onnx::ModelProto& m) {
                                  m.mutable_metadata_props(0)->set_value(
                                      "[\"HU\"]");
                                }},
                        BadOnnx{"tactus.inputs is discarded",
                                [](onnx::ModelProto& m) {
                                  m.mutable_metadata_props(1)->set_value("{");
                                }}));

TEST(OnnxTest, WeightsUsedAgainAndAgainDoNotTakeAllMemory) {
  // 200 layers that share the weights of one file of 16 MB.
  onnx::ModelProto model;
  model.add_opset_import()->set_version(11);
  onnx::GraphProto& graph = *model.mutable_graph();
  graph.add_input()->set_name("input");
  constexpr int64_t kCells = 1024;
  const auto add = [&](const char* name, std::vector<int64_t> dims) {
    onnx::TensorProto* tensor = graph.add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(1);
    int64_t count = 4;
    for (const int64_t size : dims) {
      tensor->add_dims(size);
      count *= size;
    }
    tensor->set_raw_data(std::string(static_cast<size_t>(count), '\0'));
  };
  add("W", {1, 4 * kCells, 1});
  add("R", {1, 4 * kCells, kCells});
  for (int i = 0; i < 200; ++i) {
    onnx::NodeProto* node = graph.add_node();
    node->set_op_type("LSTM");
    for (const char* name : {"input", "W", "R"}) node->add_input(name);
    node->add_output(absl::StrCat("Y", i));
  }
  const auto foreign = Read(model);
  EXPECT_THAT(std::string(foreign.status().message()),
              HasSubstr("makes the networks too large"));
}

TEST(OnnxTest, DamageIsRefusedOrGivesAValidNetwork) {
  Random random(8);
  for (const char* name :
       {"mean-of-three-sequence.onnx", "tanh-sigmoid-step.onnx",
        "torch-2-last-batch-first-opset13.onnx",
        "torch-3-last-time-first-opset9.onnx"}) {
    const std::string good = Golden(name);
    const auto check = [&](const std::string& bytes) {
      const auto foreign = LstmsFromOnnx("x.onnx", bytes);
      if (!foreign.ok()) {
        ASSERT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
        ASSERT_THAT(std::string(foreign.status().message()),
                    HasSubstr("x.onnx: "));
        return;
      }
      for (const LstmNetwork& network : foreign->lstms) {
        ASSERT_TRUE(Validate(network).ok());
      }
    };
    for (size_t length = 0; length < good.size(); length += 3) {
      check(good.substr(0, length));
    }
    for (int i = 0; i < 3000; ++i) {
      std::string bad = good;
      for (uint64_t k = random.Index(3) + 1; k > 0; --k) {
        bad[random.Index(bad.size())] ^=
            static_cast<char>(1 << random.Index(8));
      }
      check(bad);
    }
  }
}

}  // namespace
}  // namespace tactus::internal
