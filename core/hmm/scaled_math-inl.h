// File: scaled_math-inl.h
//
// Powers of two in vectors, for the kernels. Highway includes this file once
// per instruction set, after its foreach_target.h.
//
//   const auto factor = PowerOfTwo(d, exponent);
//
// Thread-safe: free functions.
#if defined(TACTUS_CORE_HMM_SCALED_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TACTUS_CORE_HMM_SCALED_MATH_INL_H_
#undef TACTUS_CORE_HMM_SCALED_MATH_INL_H_
#else
#define TACTUS_CORE_HMM_SCALED_MATH_INL_H_
#endif

#include <bit>

#include "core/hmm/scaled_kernels.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename T>
using Vector = hn::CappedTag<T, kBlock>;

template <typename T>
struct Format;
template <>
struct Format<float> {
  static constexpr int kMantissaBits = 23;
  static constexpr int kBias = 127;
  static constexpr uint32_t kMantissaMask = 0x007FFFFF;
  // Bits of 2^23 and of 1.
  static constexpr uint32_t kWhole = 0x4B000000;
  static constexpr uint32_t kOne = 0x3F800000;
  static constexpr float kWholeValue = 0x1p23F;
  // Terms of the exponential series. Further terms add less than half of the
  // rounding error.
  static constexpr int kTerms = 8;
};
template <>
struct Format<double> {
  static constexpr int kMantissaBits = 52;
  static constexpr int kBias = 1023;
  static constexpr uint64_t kMantissaMask = 0x000FFFFFFFFFFFFF;
  static constexpr uint64_t kWhole = 0x4330000000000000;
  static constexpr uint64_t kOne = 0x3FF0000000000000;
  static constexpr double kWholeValue = 0x1p52;
  static constexpr int kTerms = 14;
};

// 2^n for whole n <= 127 (1023); 0 if the result would be denormal.
template <class D, class V>
HWY_INLINE V PowerOfTwo(D d, V n) {
  using T = hn::TFromD<D>;
  using F = Format<T>;
  const hn::RebindToUnsigned<D> du;
  const V held = hn::Max(n, hn::Set(d, static_cast<T>(-F::kBias)));
  // The lowest bits of 2^23 + m, m a small whole number, are m.
  const V shifted =
      hn::Add(held, hn::Set(d, F::kWholeValue + static_cast<T>(F::kBias)));
  return hn::BitCast(d,
                     hn::ShiftLeft<F::kMantissaBits>(hn::BitCast(du, shifted)));
}

// Coefficients of 2^f = exp(f ln 2) in powers of f.
template <typename T>
struct ExponentialSeries {
  T term[Format<T>::kTerms];

  constexpr ExponentialSeries() : term() {
    double value = 1;
    for (int k = 0; k < Format<T>::kTerms; ++k) {
      term[k] = static_cast<T>(value);
      value *= 0.693147180559945309417 / (k + 1);
    }
  }
};

// kCount terms of the series from term kFirst on, divided by f^kFirst. Splits
// the sum in halves (Estrin), which has shorter dependency chains than Horner.
// power: f, f^2, f^4 ..
template <int kFirst, int kCount, class D, class V>
HWY_INLINE V PartOfSeries(D d, const V* power) {
  using T = hn::TFromD<D>;
  constexpr ExponentialSeries<T> kSeries;
  if constexpr (kCount == 1) {
    return hn::Set(d, kSeries.term[kFirst]);
  } else {
    constexpr int kHalf = static_cast<int>(std::bit_floor(kCount - 1U));
    return hn::MulAdd(PartOfSeries<kFirst + kHalf, kCount - kHalf>(d, power),
                      power[std::bit_width(static_cast<unsigned>(kHalf)) - 1],
                      PartOfSeries<kFirst, kHalf>(d, power));
  }
}

// 2^f, |f| <= 0.5.
template <class D, class V>
HWY_INLINE V PowerOfFraction(D d, V f) {
  const V squared = hn::Mul(f, f);
  const V fourth = hn::Mul(squared, squared);
  const V power[] = {f, squared, fourth, hn::Mul(fourth, fourth)};
  return PartOfSeries<0, Format<hn::TFromD<D>>::kTerms>(d, power);
}

// Brings the mantissa into [1, 2) and adds its power of two to `exponent`,
// which does not fall below kNothing.
template <class D, class V>
HWY_INLINE void Renormalise(D d, V& mantissa, V& exponent) {
  using T = hn::TFromD<D>;
  using F = Format<T>;
  const hn::RebindToUnsigned<D> du;
  const auto bits = hn::BitCast(du, mantissa);
  const V biased = hn::BitCast(d, hn::Or(hn::ShiftRight<F::kMantissaBits>(bits),
                                         hn::Set(du, F::kWhole)));
  const V added =
      hn::Sub(biased, hn::Set(d, F::kWholeValue + static_cast<T>(F::kBias)));
  exponent = hn::Max(hn::Add(exponent, added), hn::Set(d, Scaled<T>::kNothing));
  mantissa = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(du, F::kMantissaMask)),
                                   hn::Set(du, F::kOne)));
}

}  // namespace HWY_NAMESPACE
}  // namespace tactus::internal
HWY_AFTER_NAMESPACE();

#endif
