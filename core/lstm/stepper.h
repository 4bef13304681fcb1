// File: stepper.h
//
// Runs an LSTM network one frame at a time. After each step it has the
// probability of each class, and mean and variance of each regression, given
// all frames since the last Reset().
//
//   TACTUS_ASSIGN_OR_RETURN(CompiledLstm lstm, CompiledLstm::Create(network));
//   LstmStepper stepper(lstm);
//   for (const auto& features : scaled_features) {
//     stepper.Step(features);
//     Use(stepper.probability());
//   }
//
// A stepper may run several streams in lockstep, each with a separate state.
// The weights are then read once for all of them.
//
// Weights and state are float, hidden dense layers and the softmax are double.
// The same inputs give the same bits, whatever the number of streams and
// however wide the CPU's vectors are.
#pragma once

#include <span>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "core/lstm/kernels.h"
#include "core/lstm/network.h"

namespace tactus::internal {

// A network laid out for stepping. Immutable and thread-safe: any number of
// steppers may use it.
class CompiledLstm {
 public:
  // INVALID_MODEL if `network` is not valid.
  static absl::StatusOr<CompiledLstm> Create(const LstmNetwork& network);

  int inputs() const { return layers_.front().inputs; }
  int classes() const {
    return static_cast<int>(dense_bias_.size()) - 2 * regressions_;
  }
  int regressions() const { return regressions_; }

 private:
  friend class LstmStepper;

  struct Layer {
    int inputs = 0;
    int cells = 0;
    // (I + H) x Padded(4H): kernel above recurrent weights, so that one product
    // of input and last output computes all gates.
    LstmBuffer weights;
    LstmBuffer bias;  // Padded(4H)
  };

  struct Hidden {
    HiddenActivation activation = HiddenActivation::kLinear;
    Eigen::MatrixXd kernel;  // units x inputs
    Eigen::VectorXd bias;
  };

  CompiledLstm() = default;

  Activation activation_ = Activation::kTanh;
  GateActivation gate_activation_ = GateActivation::kSigmoid;
  int regressions_ = 0;
  std::vector<Layer> layers_;
  std::vector<Hidden> hidden_;
  // (Classes + 2R) x features.
  Eigen::MatrixXd dense_kernel_;
  Eigen::VectorXd dense_bias_;
};

// The state of one sequence per stream. Step() allocates nothing. Not
// thread-safe.
class LstmStepper {
 public:
  // `lstm` and `kernels` must outlive the stepper; `streams` > 0.
  explicit LstmStepper(const CompiledLstm& lstm, int streams = 1,
                       const LstmKernels& kernels = BestLstmKernels());

  // Begins a new sequence in every stream.
  void Reset();
  // Begins a new sequence in one stream.
  void Reset(int stream);

  // Processes the next frame of every stream. input: the streams' frames one
  // after another, lstm.inputs() finite numbers each, scaled as in training.
  // Magnitudes above 1e20 are clamped to 1e20.
  void Step(std::span<const double> input);

  // After the last Step(), one per class; uniform before the first.
  std::span<const double> probability(int stream = 0) const {
    return {probability_.col(stream).data(), size_t(lstm_->classes())};
  }
  // After the last Step(), one per regression; 0 before the first.
  std::span<const double> regression_mean(int stream = 0) const {
    return Outputs(stream, lstm_->classes());
  }
  std::span<const double> regression_log_variance(int stream = 0) const {
    return Outputs(stream, lstm_->classes() + lstm_->regressions());
  }

 private:
  // One row per stream.
  struct State {
    // I + Padded(H): this layer's input and its last output, in the order of
    // `weights`.
    LstmBuffer input_output;
    // The same length, H used: c and act(c).
    LstmBuffer cell;
    LstmBuffer squashed;
    // Padded(4H).
    LstmBuffer gates;
  };

  void StepLayer(size_t index);
  void StepHidden();
  void Softmax();
  // R outputs of the dense layer.
  std::span<const double> Outputs(int stream, int first) const {
    return {dense_.col(stream).data() + first, size_t(lstm_->regressions())};
  }

  const CompiledLstm* lstm_;
  const LstmKernels* kernels_;
  int streams_;
  std::vector<State> states_;
  // One column per stream: output of the last LSTM layer, H, of each hidden
  // layer, and of the dense layer, classes + 2R.
  Eigen::MatrixXd output_;
  std::vector<Eigen::MatrixXd> hidden_;
  Eigen::MatrixXd dense_;
  Eigen::MatrixXd probability_;
};

}  // namespace tactus::internal
