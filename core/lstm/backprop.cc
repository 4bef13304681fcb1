#include "core/lstm/backprop.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/errors.h"

namespace tactus::internal {
namespace {

void Grow(size_t size, LstmBuffer& values) {
  if (values.size() < size) values.resize(size);
}

// to = start + from weights, for `rows` rows.
void Forwards(const LstmKernels& kernels, int rows, const float* from,
              const PackedMatrix& matrix, const float* start, int start_row,
              float* to) {
  kernels.product({.rows = rows,
                   .inner = matrix.inputs,
                   .columns = Padded(matrix.rows),
                   .a = from,
                   .a_row = Padded(matrix.inputs),
                   .b = matrix.forward.data(),
                   .b_row = Padded(matrix.rows),
                   .start = start,
                   .start_row = start_row,
                   .c = to,
                   .c_row = Padded(matrix.rows)});
}

// to = from weights^T, for `rows` rows.
void Backwards(const LstmKernels& kernels, int rows, const float* from,
               const PackedMatrix& matrix, const LstmBuffer& zeros, float* to) {
  kernels.product({.rows = rows,
                   .inner = matrix.rows,
                   .columns = Padded(matrix.inputs),
                   .a = from,
                   .a_row = Padded(matrix.rows),
                   .b = matrix.backward.data(),
                   .b_row = Padded(matrix.inputs),
                   .start = zeros.data(),
                   .c = to,
                   .c_row = Padded(matrix.inputs)});
}

// matrix.gradient += sum over `rows` rows of inputs^T deltas.
void AddGradient(const LstmKernels& kernels, int rows, const float* inputs,
                 const float* deltas, PackedMatrix& matrix) {
  kernels.product({.rows = matrix.inputs,
                   .inner = rows,
                   .columns = Padded(matrix.rows),
                   .a = inputs,
                   .a_row = 1,
                   .a_column = Padded(matrix.inputs),
                   .b = deltas,
                   .b_row = Padded(matrix.rows),
                   .start = matrix.gradient.data(),
                   .start_row = Padded(matrix.rows),
                   .c = matrix.gradient.data(),
                   .c_row = Padded(matrix.rows)});
}

// sums = the sum of `rows` rows of deltas.
void SumRows(const LstmKernels& kernels, int rows, const float* deltas,
             LstmBuffer& sums) {
  constexpr float kOne = 1;
  const auto columns = static_cast<int>(sums.size());
  std::fill(sums.begin(), sums.end(), 0.0F);
  kernels.product({.rows = 1,
                   .inner = rows,
                   .columns = columns,
                   .a = &kOne,
                   .a_column = 0,
                   .b = deltas,
                   .b_row = columns,
                   .start = sums.data(),
                   .c = sums.data()});
}

}  // namespace

LstmBackprop::LstmBackprop(const LstmNetwork& network,
                           const LstmKernels& kernels)
    : kernels_(kernels),
      activation_(network.activation),
      gate_activation_(network.gate_activation),
      classes_(network.classes()),
      regressions_(network.regressions) {
  for (const LstmLayer& from : network.layers) {
    Layer& layer = layers_.emplace_back();
    layer.kernel = PackedMatrix(4 * from.cells, from.inputs);
    layer.recurrent = PackedMatrix(4 * from.cells, from.cells);
    layer.bias.resize(Padded(4 * from.cells));
    layer.bias_gradient.resize(layer.bias.size());
  }
  dense_ = PackedMatrix(classes_ + 2 * regressions_, layers_.back().cells());
  dense_bias_.resize(Padded(dense_.rows));
  dense_bias_gradient_.resize(dense_bias_.size());
}

void LstmBackprop::SetWeights(const LstmNetwork& network) {
  for (size_t i = 0; i < layers_.size(); ++i) {
    const LstmLayer& from = network.layers[i];
    layers_[i].kernel.SetWeights(from.kernel);
    layers_[i].recurrent.SetWeights(from.recurrent);
    std::copy(from.bias.begin(), from.bias.end(), layers_[i].bias.begin());
  }
  dense_.SetWeights(network.dense_kernel);
  std::copy(network.dense_bias.begin(), network.dense_bias.end(),
            dense_bias_.begin());
}

void LstmBackprop::Resize() {
  const size_t rows = layout_.rows;
  const size_t sequences = layout_.sequences();
  size_t widest = dense_bias_.size();
  for (Layer& layer : layers_) {
    const size_t cells = Padded(layer.cells());
    // The kernels read on past the last row.
    const size_t gates = rows * layer.bias.size() + kLstmLanes;
    Grow(gates, layer.gates);
    Grow(gates, layer.deltas);
    for (auto* buffer :
         {&layer.cell, &layer.squashed, &layer.output, &layer.by_output}) {
      Grow(rows * cells, *buffer);
    }
    Grow(sequences * cells, layer.from_next);
    Grow(sequences * cells, layer.carry);
    widest = std::max(widest, cells);
  }
  Grow(rows * dense_bias_.size(), outputs_);
  Grow(rows * dense_bias_.size(), by_outputs_);
  Grow(sequences * widest, zeros_);
}

void LstmBackprop::TakeInputs(double noise, NoiseBits& bits) {
  const int inputs = layers_.front().kernel.inputs;
  const int stride = Padded(inputs);
  LstmBuffer& rows = layers_.front().input;
  Grow(size_t(layout_.rows) * stride, rows);
  for (int i = 0; i < layout_.sequences(); ++i) {
    const float* from = batch_[layout_.order[i]].inputs.data();
    for (int t = 0; t < layout_.steps[i]; ++t, from += inputs) {
      float* to = &rows[layout_.Row(t, i) * stride];
      std::copy_n(from, inputs, to);
      if (noise > 0) AddNoise(noise, bits, {to, size_t(inputs)});
    }
  }
}

void LstmBackprop::DropInputs(size_t layer, double dropout, NoiseBits& bits) {
  const Layer& below = layers_[layer - 1];
  LstmBuffer& input = layers_[layer].input;
  LstmBuffer& mask = layers_[layer].mask;
  const size_t size = size_t(layout_.rows) * Padded(below.cells());
  Grow(size, input);
  Grow(size, mask);
  DropoutMask(dropout, bits, std::span(mask).first(size));
  for (size_t k = 0; k < size; ++k) input[k] = below.output[k] * mask[k];
}

const LstmBuffer& LstmBackprop::InputOf(size_t layer) const {
  return layer == 0 || dropping_ ? layers_[layer].input
                                 : layers_[layer - 1].output;
}

LstmCellShape LstmBackprop::ShapeOf(const Layer& layer, int rows) const {
  return {.rows = rows,
          .cells = layer.cells(),
          .activation = activation_,
          .gate_activation = gate_activation_,
          .gate_row = Padded(4 * layer.cells()),
          .cell_row = Padded(layer.cells())};
}

void LstmBackprop::Forward(std::span<const LstmSequence> batch,
                           const LstmNoise& noise, Random& random) {
  batch_ = batch;
  dropping_ = noise.dropout > 0;
  steps_.clear();
  for (const LstmSequence& sequence : batch) {
    steps_.push_back(static_cast<int>(sequence.inputs.size()) /
                     layers_.front().kernel.inputs);
  }
  layout_.Arrange(steps_);
  Resize();
  NoiseBits bits(random);
  TakeInputs(noise.input, bits);
  for (size_t i = 0; i < layers_.size(); ++i) {
    if (i > 0 && dropping_) DropInputs(i, noise.dropout, bits);
    ForwardLayer(i);
  }
  Forwards(kernels_, layout_.rows, layers_.back().output.data(), dense_,
           dense_bias_.data(), 0, outputs_.data());
}

void LstmBackprop::ForwardLayer(size_t index) {
  Layer& layer = layers_[index];
  Forwards(kernels_, layout_.rows, InputOf(index).data(), layer.kernel,
           layer.bias.data(), 0, layer.gates.data());
  const float* previous_cell = zeros_.data();
  const float* previous_output = nullptr;
  for (size_t t = 0; t < layout_.active.size(); ++t) {
    const LstmCellShape shape = ShapeOf(layer, layout_.active[t]);
    const ptrdiff_t at = layout_.first[t] * shape.cell_row;
    float* gates = &layer.gates[layout_.first[t] * shape.gate_row];
    if (t > 0) {
      Forwards(kernels_, shape.rows, previous_output, layer.recurrent, gates,
               static_cast<int>(shape.gate_row), gates);
    }
    kernels_.cell_forward({.shape = shape,
                           .gates = gates,
                           .previous = previous_cell,
                           .cell = &layer.cell[at],
                           .squashed = &layer.squashed[at],
                           .output = &layer.output[at]});
    previous_cell = &layer.cell[at];
    previous_output = &layer.output[at];
  }
}

LstmBatchLoss LstmBackprop::Loss(const LstmLossOptions& options) {
  const size_t stride = dense_bias_.size();
  std::fill_n(by_outputs_.begin(), layout_.rows * stride, 0.0F);
  LstmBatchLoss total;
  for (int i = 0; i < layout_.sequences(); ++i) {
    const LstmSequence& sequence = batch_[layout_.order[i]];
    const int steps = layout_.steps[i];
    int counted = 0;
    for (int t = 0; t < steps; ++t) counted += Counts(options, t, steps);
    const double mean = 1.0 / layout_.sequences();
    const double share = mean * sequence.weight / counted;
    double loss = 0;
    for (int t = 0; t < steps; ++t) {
      if (!Counts(options, t, steps)) continue;
      const size_t at = layout_.Row(t, i) * stride;
      const auto targets = sequence.targets.empty()
                               ? sequence.targets
                               : sequence.targets.subspan(
                                     size_t(t) * regressions_, regressions_);
      loss += StepLoss(options, classes_, regressions_, &outputs_[at],
                       sequence.LabelAt(t), targets, share, &by_outputs_[at]);
    }
    total.sum += loss / mean;
    const float* last = &outputs_[layout_.Row(steps - 1, i) * stride];
    total.correct += std::max_element(last, last + classes_) - last ==
                     sequence.LabelAt(steps - 1);
  }
  return total;
}

void LstmBackprop::Backward(LstmNetwork& gradient) {
  const Layer& last = layers_.back();
  std::fill(dense_.gradient.begin(), dense_.gradient.end(), 0.0F);
  AddGradient(kernels_, layout_.rows, last.output.data(), by_outputs_.data(),
              dense_);
  SumRows(kernels_, layout_.rows, by_outputs_.data(), dense_bias_gradient_);
  dense_.GetGradient(gradient.dense_kernel);
  std::copy_n(dense_bias_gradient_.begin(), gradient.dense_bias.size(),
              gradient.dense_bias.begin());
  Backwards(kernels_, layout_.rows, by_outputs_.data(), dense_, zeros_,
            layers_.back().by_output.data());
  for (size_t i = layers_.size(); i-- > 0;) {
    BackwardLayer(i);
    WeightGradients(i);
    const Layer& layer = layers_[i];
    LstmLayer& to = gradient.layers[i];
    layer.kernel.GetGradient(to.kernel);
    layer.recurrent.GetGradient(to.recurrent);
    std::copy_n(layer.bias_gradient.begin(), to.bias.size(), to.bias.begin());
    if (i == 0) return;
    LstmBuffer& below = layers_[i - 1].by_output;
    Backwards(kernels_, layout_.rows, layer.deltas.data(), layer.kernel, zeros_,
              below.data());
    if (!dropping_) continue;
    const size_t size = size_t(layout_.rows) * Padded(layer.kernel.inputs);
    for (size_t k = 0; k < size; ++k) below[k] *= layer.mask[k];
  }
}

void LstmBackprop::BackwardLayer(size_t index) {
  Layer& layer = layers_[index];
  std::fill(layer.from_next.begin(), layer.from_next.end(), 0.0F);
  std::fill(layer.carry.begin(), layer.carry.end(), 0.0F);
  for (size_t t = layout_.active.size(); t-- > 0;) {
    const LstmCellShape shape = ShapeOf(layer, layout_.active[t]);
    const ptrdiff_t gates = layout_.first[t] * shape.gate_row;
    const ptrdiff_t at = layout_.first[t] * shape.cell_row;
    const float* previous =
        t == 0 ? zeros_.data()
               : &layer.cell[layout_.first[t - 1] * shape.cell_row];
    kernels_.cell_backward({.shape = shape,
                            .gates = &layer.gates[gates],
                            .previous = previous,
                            .squashed = &layer.squashed[at],
                            .from_above = &layer.by_output[at],
                            .from_next = layer.from_next.data(),
                            .carry = layer.carry.data(),
                            .deltas = &layer.deltas[gates]});
    if (t == 0) return;
    Backwards(kernels_, shape.rows, &layer.deltas[gates], layer.recurrent,
              zeros_, layer.from_next.data());
  }
}

void LstmBackprop::WeightGradients(size_t index) {
  Layer& layer = layers_[index];
  const float* deltas = layer.deltas.data();
  std::fill(layer.kernel.gradient.begin(), layer.kernel.gradient.end(), 0.0F);
  AddGradient(kernels_, layout_.rows, InputOf(index).data(), deltas,
              layer.kernel);
  SumRows(kernels_, layout_.rows, deltas, layer.bias_gradient);

  std::fill(layer.recurrent.gradient.begin(), layer.recurrent.gradient.end(),
            0.0F);
  const LstmCellShape shape = ShapeOf(layer, 0);
  // h[t-1] lies as many rows before the deltas of t as sequences reach t-1:
  // one product per stretch of steps for which that is one number.
  const size_t steps = layout_.active.size();
  for (size_t from = 1, to = 1; from < steps; from = to) {
    const int distance = layout_.active[from - 1];
    while (to < steps && layout_.active[to - 1] == distance) ++to;
    const ptrdiff_t first = layout_.first[from];
    const int end = to < steps ? layout_.first[to] : layout_.rows;
    AddGradient(kernels_, static_cast<int>(end - first),
                &layer.output[(first - distance) * shape.cell_row],
                deltas + first * shape.gate_row, layer.recurrent);
  }
}

}  // namespace tactus::internal
