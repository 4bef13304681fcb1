// File: history_kernels.h
//
// The loops of TouchHistory and of the ridge, compiled for each instruction
// set. Sums are taken in one order, so all give the same bits.
//
//   AddChannels(values.data(), count, sums);
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::internal {

// Channels are padded to a multiple of this.
inline constexpr size_t kChannelPadding = 8;
constexpr size_t PaddedChannels(size_t channels) {
  return (channels + kChannelPadding - 1) / kChannelPadding * kChannelPadding;
}

// One element per channel.
struct ChannelSums {
  const float* previous;
  double* sum;
  double* square;
  double* steps;
  float* largest;
  float* smallest;
  float* short_mean;
  float* long_mean;
  uint32_t* active;
  double* block;
  // Weights of the newest frame in the two means.
  float short_weight;
  float long_weight;
};

// Adds a frame to the sums. `count` is a multiple of kChannelPadding. A step is
// rounded to float, as values are.
void AddChannels(const float* values, size_t count, const ChannelSums& sums);

// The values of the kernels of one dilation: `taps` points to the series of
// kMiniLanes kernels at each of kMiniTaps frames, the newest first. Counts
// those above the thresholds, [kMiniThresholds][kMiniLanes].
void StepMiniKernels(const float* const* taps, const float* thresholds,
                     float* values, uint32_t* above);

// mean[i] = weight * x[i] + mean[i].
void AddScaled(float weight, const float* x, size_t count, float* mean);

// z = (x - offset) * gain within plus and minus limit.
void Standardise(std::span<const float> x, std::span<const float> offset,
                 std::span<const float> gain, float limit, std::span<float> z);

// The sum of products, in kDotStripes partial sums.
inline constexpr size_t kDotStripes = 32;
float DotProduct(std::span<const float> x, std::span<const float> y);
// The sum of squared differences, likewise.
float SquaredDistance(std::span<const float> x, std::span<const float> y);

}  // namespace tactus::internal
