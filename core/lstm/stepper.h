// File: stepper.h
//
// Runs an LSTM network one frame at a time: probability per class, and mean and
// variance of what it regresses, after each step, given all frames since the
// last Reset().
//
//   TACTUS_ASSIGN_OR_RETURN(CompiledLstm lstm, CompiledLstm::Create(network));
//   LstmStepper stepper(lstm);
//   for (const auto& features : scaled_features) {
//     stepper.Step(features);
//     ... stepper.probability() ...
//   }
//
// Weights and state are float, the softmax is double. The same inputs give the
// same bits.
#pragma once

#include <span>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "core/lstm/network.h"

namespace tactus {

// A network laid out for stepping. Immutable: one serves any number of
// steppers in any number of threads.
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
    // 4H x (I + H): kernel and recurrent weights side by side; rows i, f, o, c,
    // so that the three gates lie together.
    Eigen::MatrixXf weights;
    Eigen::VectorXf bias;
  };

  CompiledLstm() = default;

  Activation activation_ = Activation::kTanh;
  GateActivation gate_activation_ = GateActivation::kSigmoid;
  int regressions_ = 0;
  std::vector<Layer> layers_;
  // (Classes + 2R) x H.
  Eigen::MatrixXd dense_kernel_;
  Eigen::VectorXd dense_bias_;
};

// The state of one sequence. Step() allocates nothing. Not thread-safe; one
// per stream.
class LstmStepper {
 public:
  // `lstm` must outlive the stepper.
  explicit LstmStepper(const CompiledLstm& lstm);

  // Begins a new sequence.
  void Reset();

  // Takes the next frame: lstm.inputs() finite numbers, scaled as in training.
  // Any magnitude is safe; beyond 1e20 it counts as 1e20.
  void Step(std::span<const double> input);

  // After the last Step(), one per class; uniform before the first.
  std::span<const double> log_probability() const {
    return {log_probability_.data(), size_t(log_probability_.size())};
  }
  std::span<const double> probability() const {
    return {probability_.data(), size_t(probability_.size())};
  }
  // After the last Step(), one per regression; 0 before the first.
  std::span<const double> regression_mean() const {
    return Outputs(lstm_->classes());
  }
  std::span<const double> regression_log_variance() const {
    return Outputs(lstm_->classes() + lstm_->regressions());
  }

 private:
  struct State {
    // I + H: this layer's input and its last output, as `weights` takes them.
    Eigen::VectorXf input_output;
    // H: c.
    Eigen::VectorXf cell;
    // 4H: the rows of `weights`, then the gates made of them.
    Eigen::VectorXf gates;
    // H: act(c).
    Eigen::VectorXf squashed;
  };

  void StepLayer(const CompiledLstm::Layer& layer, State& state) const;
  void Softmax();
  // R outputs of the dense layer.
  std::span<const double> Outputs(int first) const {
    return {dense_.data() + first, size_t(lstm_->regressions())};
  }

  const CompiledLstm* lstm_;
  std::vector<State> states_;
  // Output of the last layer, H.
  Eigen::VectorXd output_;
  // Output of the dense layer, classes + 2R.
  Eigen::VectorXd dense_;
  Eigen::VectorXd log_probability_;
  Eigen::VectorXd probability_;
};

}  // namespace tactus
