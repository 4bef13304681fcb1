#include "core/features/touched.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/features/touched.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::HWY_NAMESPACE {
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

constexpr size_t kStripes = TouchedAdder::kStripes;

void SumTouched(const float* taxels, size_t count, const uint64_t* bits,
                TouchedSum* sum) {
  constexpr hn::CappedTag<double, 8> d;
  constexpr hn::Rebind<float, decltype(d)> f;
  constexpr size_t kLanes = hn::MaxLanes(d);
  constexpr size_t kParts = kStripes / kLanes;
  auto largest = hn::Zero(f);
  decltype(hn::Zero(d)) totals[kParts];
  for (auto& total : totals) total = hn::Zero(d);
  for (size_t from = 0; from < count; from += kStripes) {
    const uint64_t word = bits[from / 64];
    if (word == 0) {
      from += 64 - kStripes;
      continue;
    }
    const float* values = taxels + from;
    float padded[kStripes] = {};
    if (count - from < kStripes) {
      std::copy(values, taxels + count, padded);
      values = padded;
    }
    for (size_t part = 0; part < kParts; ++part) {
      const auto byte =
          static_cast<uint8_t>(word >> (from % 64 + part * kLanes));
      const auto value = hn::IfThenElseZero(
          hn::LoadMaskBits(f, &byte), hn::LoadU(f, values + part * kLanes));
      largest = hn::Max(largest, value);
      totals[part] = hn::Add(totals[part], hn::PromoteTo(d, value));
    }
  }
  std::array<double, kStripes> stripes;
  for (size_t part = 0; part < kParts; ++part) {
    hn::StoreU(totals[part], d, stripes.data() + part * kLanes);
  }
  sum->max_value = hn::GetLane(hn::MaxOfLanes(f, largest));
  sum->total = TouchedAdder::SumOfStripes(stripes);
}

}  // namespace tactus::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(FindTouched);
HWY_EXPORT(SumTouched);

bool FindTouched(std::span<const float> taxels, float threshold,
                 std::span<uint64_t> bits) {
  return HWY_DYNAMIC_DISPATCH(FindTouched)(taxels.data(), taxels.size(),
                                           threshold, bits.data());
}

TouchedSum SumTouched(std::span<const float> taxels,
                      std::span<const uint64_t> bits) {
  TouchedSum sum;
  HWY_DYNAMIC_DISPATCH(SumTouched)
  (taxels.data(), taxels.size(), bits.data(), &sum);
  return sum;
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
