#include "core/lstm/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/base/errors.h"

namespace tactus::internal {
namespace {

constexpr int kNoiseBits = 12;
constexpr size_t kNoiseValues = size_t{1} << kNoiseBits;
using NoiseTable = std::array<float, kNoiseValues>;

// The x > 0 with P(normal > x) = p, by bisection.
double UpperQuantile(double p) {
  double low = 0;
  double high = 6;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double above = 0.5 * std::erfc(middle / std::numbers::sqrt2);
    (above > p ? low : high) = middle;
  }
  return low;
}

NoiseTable MakeNoiseTable() {
  constexpr size_t kHalf = kNoiseValues / 2;
  std::array<double, kHalf> upper;
  double squares = 0;
  for (size_t i = 0; i < kHalf; ++i) {
    upper[i] =
        UpperQuantile((static_cast<double>(i) + 0.5) / double{kNoiseValues});
    squares += upper[i] * upper[i];
  }
  const double scale = 1 / std::sqrt(squares / double{kHalf});
  NoiseTable table;
  for (size_t i = 0; i < kHalf; ++i) {
    table[i] = static_cast<float>(scale * upper[i]);
    table[kNoiseValues - 1 - i] = -table[i];
  }
  return table;
}

}  // namespace

absl::Status Validate(const LstmNoise& noise) {
  if (!(noise.dropout >= 0 && noise.dropout < 1)) {
    return InvalidConfig("dropout", noise.dropout, "at least 0 and below 1");
  }
  if (!(noise.input >= 0 && std::isfinite(noise.input))) {
    return InvalidConfig("input noise", noise.input, "finite and at least 0");
  }
  return absl::OkStatus();
}

void DropoutMask(double probability, NoiseBits& source, std::span<float> mask) {
  constexpr int kBits = 16;
  constexpr size_t kDraws = 64 / kBits;
  constexpr uint64_t kRange = uint64_t{1} << kBits;
  const uint64_t dropped = std::min(
      static_cast<uint64_t>(std::lround(probability * kRange)), kRange - 1);
  const float kept = static_cast<float>(static_cast<double>(kRange) /
                                        static_cast<double>(kRange - dropped));
  const auto draw = [&](size_t at, size_t count) {
    const uint64_t bits = source.Next();
    for (size_t j = 0; j < count; ++j) {
      // A multiplication, because a branch would be mispredicted one time in
      // five.
      const bool keeps = (bits >> (kBits * j)) % kRange >= dropped;
      mask[at + j] = kept * static_cast<float>(keeps);
    }
  };
  size_t i = 0;
  for (; i + kDraws <= mask.size(); i += kDraws) draw(i, kDraws);
  if (i < mask.size()) draw(i, mask.size() - i);
}

void AddNoise(double deviation, NoiseBits& source, std::span<float> values) {
  static const NoiseTable table = MakeNoiseTable();
  constexpr size_t kDraws = 64 / kNoiseBits;
  const auto scale = static_cast<float>(deviation);
  const auto draw = [&](size_t at, size_t count) {
    const uint64_t bits = source.Next();
    for (size_t j = 0; j < count; ++j) {
      values[at + j] +=
          scale * table[(bits >> (kNoiseBits * j)) % kNoiseValues];
    }
  };
  size_t i = 0;
  for (; i + kDraws <= values.size(); i += kDraws) draw(i, kDraws);
  if (i < values.size()) draw(i, values.size() - i);
}

}  // namespace tactus::internal
