#include "core/lstm/noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/errors.h"

namespace tactus {

absl::Status Validate(const LstmNoise& noise) {
  if (!(noise.dropout >= 0 && noise.dropout < 1)) {
    return InvalidConfig("dropout", noise.dropout, "at least 0 and below 1");
  }
  if (!(noise.input >= 0 && std::isfinite(noise.input))) {
    return InvalidConfig("input noise", noise.input, "finite and at least 0");
  }
  return absl::OkStatus();
}

void DropoutMask(double probability, Random& random, std::span<float> mask) {
  constexpr int kBits = 16;
  constexpr size_t kDraws = 64 / kBits;
  constexpr uint64_t kRange = uint64_t{1} << kBits;
  const uint64_t dropped = std::min(
      static_cast<uint64_t>(std::lround(probability * kRange)), kRange - 1);
  const float kept = static_cast<float>(static_cast<double>(kRange) /
                                        static_cast<double>(kRange - dropped));
  const auto draw = [&](size_t at, size_t count) {
    const uint64_t bits = random.Index(std::numeric_limits<uint64_t>::max());
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

}  // namespace tactus
