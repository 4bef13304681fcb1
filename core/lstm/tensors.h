// File: tensors.h
//
// The weights of a network, tensor by tensor.
//
//   ForEachTensor(gradient, [&](std::vector<float>& weights, bool is_kernel) {
//     for (float& weight : weights) weight *= 0.5F;
//   });
//
// Thread-safe: a free function without state.
#pragma once

namespace tactus::internal {

// Calls take(weights, is_kernel) for each tensor of a network without hidden
// layers, always in the same order.
template <typename Network, typename Take>
void ForEachTensor(Network& network, Take take) {
  for (auto& layer : network.layers) {
    take(layer.kernel, true);
    take(layer.recurrent, true);
    take(layer.bias, false);
  }
  take(network.dense_kernel, true);
  take(network.dense_bias, false);
}

}  // namespace tactus::internal
