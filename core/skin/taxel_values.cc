#include "core/skin/taxel_values.h"

#include <cstddef>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/skin/taxel_values.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
hn::Vec<D> LoadAsDouble(D d, const char* wire, uint16_t) {
  const hn::Rebind<uint16_t, D> narrow;
  const hn::Rebind<int32_t, D> wide;
  const auto numbers =
      hn::LoadU(narrow, reinterpret_cast<const uint16_t*>(wire));
  return hn::PromoteTo(d, hn::PromoteTo(wide, numbers));
}

template <class D>
hn::Vec<D> LoadAsDouble(D d, const char* wire, float) {
  const hn::Rebind<float, D> narrow;
  return hn::PromoteTo(d,
                       hn::LoadU(narrow, reinterpret_cast<const float*>(wire)));
}

template <typename Number>
bool Scale(const char* wire, size_t count, double scale, float limit,
           float* taxels) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> f;
  const size_t lanes = hn::Lanes(d);
  const auto factor = hn::Set(d, scale);
  const auto zero = hn::Zero(f);
  const auto most = hn::Set(f, limit);
  auto good = hn::Eq(zero, zero);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto numbers = LoadAsDouble(d, wire + i * sizeof(Number), Number{});
    const auto value = hn::DemoteTo(f, hn::Mul(numbers, factor));
    good = hn::And(good, hn::And(hn::Ge(value, zero), hn::Le(value, most)));
    hn::StoreU(value, f, taxels + i);
  }
  bool all = hn::AllTrue(f, good);
  for (; i < count; ++i) {
    Number number;
    std::memcpy(&number, wire + i * sizeof(Number), sizeof(Number));
    taxels[i] = ScaledTaxel(number, scale);
    all &= taxels[i] >= 0 && taxels[i] <= limit;
  }
  return all;
}

bool ScaleU16(const char* wire, size_t count, double scale, float limit,
              float* taxels) {
  return Scale<uint16_t>(wire, count, scale, limit, taxels);
}

bool ScaleF32(const char* wire, size_t count, double scale, float limit,
              float* taxels) {
  return Scale<float>(wire, count, scale, limit, taxels);
}

}  // namespace tactus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus {

HWY_EXPORT(ScaleU16);
HWY_EXPORT(ScaleF32);

template <>
bool ScaleTaxels<uint16_t>(const char* wire, double scale, float limit,
                           std::span<float> taxels) {
  return HWY_DYNAMIC_DISPATCH(ScaleU16)(wire, taxels.size(), scale, limit,
                                        taxels.data());
}

template <>
bool ScaleTaxels<float>(const char* wire, double scale, float limit,
                        std::span<float> taxels) {
  return HWY_DYNAMIC_DISPATCH(ScaleF32)(wire, taxels.size(), scale, limit,
                                        taxels.data());
}

}  // namespace tactus
#endif  // HWY_ONCE
