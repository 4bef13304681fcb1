#include "core/skin/taxel_values.h"

#include <cstddef>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/skin/taxel_values.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::HWY_NAMESPACE {
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
hn::Vec<D> LoadAsDouble(D d, const char* wire, int16_t) {
  const hn::Rebind<int16_t, D> narrow;
  const hn::Rebind<int32_t, D> wide;
  const auto numbers =
      hn::LoadU(narrow, reinterpret_cast<const int16_t*>(wire));
  return hn::PromoteTo(d, hn::PromoteTo(wide, numbers));
}

template <class D>
hn::Vec<D> LoadAsDouble(D d, const char* wire, float) {
  const hn::Rebind<float, D> narrow;
  return hn::PromoteTo(d,
                       hn::LoadU(narrow, reinterpret_cast<const float*>(wire)));
}

// ScaledTaxel() of the vector at `wire`.
template <typename Number, class D>
hn::Vec<hn::Rebind<float, D>> Scaled(D d, const char* wire, hn::Vec<D> factor) {
  const hn::Rebind<float, D> f;
  return hn::DemoteTo(f, hn::Mul(LoadAsDouble(d, wire, Number{}), factor));
}

template <typename Number>
float ScaledAt(const char* wire, double scale) {
  Number number;
  std::memcpy(&number, wire, sizeof(Number));
  return ScaledTaxel(number, scale);
}

template <typename Number>
void Scale(const char* wire, size_t count, double scale, float* taxels) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> f;
  const size_t lanes = hn::Lanes(d);
  const auto factor = hn::Set(d, scale);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(Scaled<Number>(d, wire + i * sizeof(Number), factor), f,
               taxels + i);
  }
  for (; i < count; ++i) {
    taxels[i] = ScaledAt<Number>(wire + i * sizeof(Number), scale);
  }
}

template <typename Number>
bool Within(const char* wire, size_t count, double scale, float lowest,
            float largest) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> f;
  const size_t lanes = hn::Lanes(d);
  const auto factor = hn::Set(d, scale);
  const auto least = hn::Set(f, lowest);
  const auto most = hn::Set(f, largest);
  auto good = hn::Eq(most, most);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto value = Scaled<Number>(d, wire + i * sizeof(Number), factor);
    good = hn::And(good, hn::And(hn::Ge(value, least), hn::Le(value, most)));
  }
  bool all = hn::AllTrue(f, good);
  for (; i < count; ++i) {
    const float value = ScaledAt<Number>(wire + i * sizeof(Number), scale);
    all &= value >= lowest && value <= largest;
  }
  return all;
}

void ScaleU16(const char* wire, size_t count, double scale, float* taxels) {
  Scale<uint16_t>(wire, count, scale, taxels);
}

void ScaleI16(const char* wire, size_t count, double scale, float* taxels) {
  Scale<int16_t>(wire, count, scale, taxels);
}

void ScaleF32(const char* wire, size_t count, double scale, float* taxels) {
  Scale<float>(wire, count, scale, taxels);
}

bool WithinU16(const char* wire, size_t count, double scale, float lowest,
               float largest) {
  return Within<uint16_t>(wire, count, scale, lowest, largest);
}

bool WithinI16(const char* wire, size_t count, double scale, float lowest,
               float largest) {
  return Within<int16_t>(wire, count, scale, lowest, largest);
}

bool WithinF32(const char* wire, size_t count, double scale, float lowest,
               float largest) {
  return Within<float>(wire, count, scale, lowest, largest);
}

}  // namespace tactus::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(ScaleU16);
HWY_EXPORT(ScaleI16);
HWY_EXPORT(ScaleF32);
HWY_EXPORT(WithinU16);
HWY_EXPORT(WithinI16);
HWY_EXPORT(WithinF32);

namespace {

template <typename Number>
float ScaledNumber(const char* wire, double scale) {
  Number number;
  std::memcpy(&number, wire, sizeof(Number));
  return ScaledTaxel(number, scale);
}

}  // namespace

size_t TaxelBytes(v1::TaxelType type) {
  switch (type) {
    case v1::TAXEL_TYPE_UINT16:
    case v1::TAXEL_TYPE_INT16:
      return 2;
    case v1::TAXEL_TYPE_FLOAT32:
      return 4;
    default:
      return 0;
  }
}

float ScaledTaxel(v1::TaxelType type, const char* wire, double scale) {
  switch (type) {
    case v1::TAXEL_TYPE_UINT16:
      return ScaledNumber<uint16_t>(wire, scale);
    case v1::TAXEL_TYPE_INT16:
      return ScaledNumber<int16_t>(wire, scale);
    default:
      return ScaledNumber<float>(wire, scale);
  }
}

void ScaleTaxels(v1::TaxelType type, const char* wire, double scale,
                 std::span<float> taxels) {
  switch (type) {
    case v1::TAXEL_TYPE_UINT16:
      HWY_DYNAMIC_DISPATCH(ScaleU16)
      (wire, taxels.size(), scale, taxels.data());
      return;
    case v1::TAXEL_TYPE_INT16:
      HWY_DYNAMIC_DISPATCH(ScaleI16)
      (wire, taxels.size(), scale, taxels.data());
      return;
    default:
      HWY_DYNAMIC_DISPATCH(ScaleF32)
      (wire, taxels.size(), scale, taxels.data());
  }
}

bool TaxelsWithin(v1::TaxelType type, const char* wire, size_t count,
                  double scale, const TaxelRange& range) {
  switch (type) {
    case v1::TAXEL_TYPE_UINT16:
      return HWY_DYNAMIC_DISPATCH(WithinU16)(wire, count, scale, range.lowest,
                                             range.largest);
    case v1::TAXEL_TYPE_INT16:
      return HWY_DYNAMIC_DISPATCH(WithinI16)(wire, count, scale, range.lowest,
                                             range.largest);
    default:
      return HWY_DYNAMIC_DISPATCH(WithinF32)(wire, count, scale, range.lowest,
                                             range.largest);
  }
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
