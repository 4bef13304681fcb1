// File: network_stack.h
//
// NetworkStack: puts the layers of another program's classifier together, first
// layer first, as one LstmNetwork.
//
//   NetworkStack stack;
//   std::string fault = stack.AddLstm(layer, activation, gate_activation);
//   fault = stack.AddDense(/*units=*/32, kernel, bias);
//   fault = stack.Activate(HiddenActivation::kRelu);
//   fault = stack.AddDense(/*units=*/4, kernel, bias);
//   std::optional<LstmNetwork> network = stack.Finish(/*softmax=*/true,
//   &fault);
//
// Factors and summands of features, which batch normalization is when a model
// is used, become part of the weights before or behind them. They are computed
// in double precision and rounded once per layer.
//
// A fault says what is wrong with the layer, for the caller to put the layer's
// name before it; it is empty if the layer was added. Copyable; not
// thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/lstm/network.h"

namespace tactus::internal {

class NetworkStack {
 public:
  // Numbers that come out of the layers so far; 0 if there are none.
  int width() const { return network_.features(); }
  bool has_lstm() const { return !network_.layers.empty(); }
  bool has_dense() const { return !network_.hidden.empty(); }
  int64_t parameter_count() const { return network_.parameter_count(); }

  [[nodiscard]] std::string AddLstm(LstmLayer layer, Activation activation,
                                    GateActivation gate_activation);
  // A linear layer. `kernel`: units x width(), row-major; `bias`: units.
  [[nodiscard]] std::string AddDense(int units, std::vector<float> kernel,
                                     std::vector<float> bias);
  // Each feature x becomes scale x + shift. Both have one number per feature;
  // before the first layer, that is any number.
  [[nodiscard]] std::string Scale(const std::vector<double>& scale,
                                  const std::vector<double>& shift);
  // Batch normalization: gamma (x - mean) / sqrt(variance + epsilon) + beta,
  // each with one number per feature.
  [[nodiscard]] std::string Normalize(const std::vector<double>& gamma,
                                      const std::vector<double>& beta,
                                      const std::vector<double>& mean,
                                      const std::vector<double>& variance,
                                      double epsilon);
  [[nodiscard]] std::string Activate(HiddenActivation activation);

  // The network, if its last layer gives the classes: with a softmax behind it,
  // as logits without one, or as a single unit with a sigmoid, which is the
  // probability of the second of two classes. Nothing, and `fault`, otherwise.
  std::optional<LstmNetwork> Finish(bool softmax, std::string* fault) const;

 private:
  // Factors and summands that no layer holds yet.
  struct Affine {
    std::vector<double> scale;
    std::vector<double> shift;
  };

  // The last layer is a dense one that nothing has followed.
  bool open() const { return has_dense() && open_; }
  // A layer that passes the features on, with what is pending.
  [[nodiscard]] std::string AddIdentity();

  // Its `hidden` are all dense layers so far, and it has no output layer.
  LstmNetwork network_;
  bool open_ = false;
  std::optional<Affine> pending_;
};

}  // namespace tactus::internal
