#include "core/lstm/dropout.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tactus {

void DropoutMask(double probability, Random& random, std::span<float> mask) {
  constexpr int kBits = 16;
  constexpr int kDraws = 64 / kBits;
  constexpr uint64_t kRange = uint64_t{1} << kBits;
  const uint64_t dropped = std::min(
      static_cast<uint64_t>(std::lround(probability * kRange)), kRange - 1);
  const float kept = static_cast<float>(static_cast<double>(kRange) /
                                        static_cast<double>(kRange - dropped));
  for (size_t i = 0; i < mask.size(); i += kDraws) {
    uint64_t bits = random.Index(std::numeric_limits<uint64_t>::max());
    const size_t end = std::min(mask.size(), i + kDraws);
    for (size_t j = i; j < end; ++j, bits >>= kBits) {
      mask[j] = bits % kRange < dropped ? 0.0F : kept;
    }
  }
}

}  // namespace tactus
