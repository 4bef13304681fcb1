#include "core/features/touched.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/features/touched.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

bool FindTouched(const float* taxels, size_t count, float threshold,
                 uint64_t* bits) {
  const hn::CappedTag<float, 64> d;
  const size_t lanes = hn::Lanes(d);
  const auto limit = hn::Set(d, threshold);
  uint64_t any = 0;
  size_t i = 0;
  for (; i + 64 <= count; i += 64) {
    uint64_t word = 0;
    for (size_t j = 0; j < 64; j += lanes) {
      const auto touched = hn::Ge(hn::LoadU(d, taxels + i + j), limit);
      uint64_t part = 0;
      hn::StoreMaskBits(d, touched, reinterpret_cast<uint8_t*>(&part));
      word |= part << j;
    }
    bits[i / 64] = word;
    any |= word;
  }
  if (i == count) return any != 0;
  uint64_t word = 0;
  for (size_t j = 0; i + j < count; ++j) {
    word |= uint64_t{taxels[i + j] >= threshold} << j;
  }
  bits[i / 64] = word;
  return (any | word) != 0;
}

}  // namespace tactus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus {

HWY_EXPORT(FindTouched);

bool FindTouched(std::span<const float> taxels, float threshold,
                 std::span<uint64_t> bits) {
  return HWY_DYNAMIC_DISPATCH(FindTouched)(taxels.data(), taxels.size(),
                                           threshold, bits.data());
}

}  // namespace tactus
#endif  // HWY_ONCE
