#include "core/base/gaussian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/base/gaussian.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Terms of atanh(s) / s, sin(a) / a and cos(a), by powers of the square.
constexpr std::array<double, 11> kAtanh = [] {
  std::array<double, 11> terms;
  for (size_t n = 0; n < terms.size(); ++n) terms[n] = 1.0 / (2 * n + 1);
  return terms;
}();
constexpr std::array<double, 9> kSine = [] {
  std::array<double, 9> terms = {1};
  for (size_t n = 1; n < terms.size(); ++n) {
    terms[n] = -terms[n - 1] / ((2.0 * n) * (2 * n + 1));
  }
  return terms;
}();
constexpr std::array<double, 10> kCosine = [] {
  std::array<double, 10> terms = {1};
  for (size_t n = 1; n < terms.size(); ++n) {
    terms[n] = -terms[n - 1] / ((2.0 * n - 1) * (2 * n));
  }
  return terms;
}();

template <class V>
using Tag = hn::DFromV<V>;

template <class V>
HWY_INLINE V Times(double factor, V x) {
  return hn::Mul(hn::Set(Tag<V>(), factor), x);
}

template <class V>
HWY_INLINE V Less(V x, double by) {
  return hn::Sub(x, hn::Set(Tag<V>(), by));
}

template <class V>
HWY_INLINE V OneMinus(V x) {
  return hn::Sub(hn::Set(Tag<V>(), 1), x);
}

// Rounds to a whole number: adding and taking away 1.5 * 2^52 does.
template <class V>
HWY_INLINE V Rounded(V x) {
  const V rounder = hn::Set(Tag<V>(), 0x1.8p52);
  return hn::Sub(hn::Add(x, rounder), rounder);
}

template <size_t kTerms, class V>
HWY_INLINE V Horner(const std::array<double, kTerms>& terms, V x) {
  const Tag<V> d;
  V sum = hn::Set(d, terms[kTerms - 1]);
  for (size_t n = kTerms - 1; n-- > 0;) {
    sum = hn::Add(hn::Mul(sum, x), hn::Set(d, terms[n]));
  }
  return sum;
}

// Natural logarithm, 0 < x <= 1, without branches.
template <class V>
HWY_INLINE V Logarithm(V x) {
  // x = mantissa 2^exponent, the mantissa within sqrt(2) of 1.
  constexpr uint64_t kRootHalf = 0x3FE6A09E667F3BCD;
  constexpr uint64_t kOne = 0x3FF0000000000000;
  const Tag<V> d;
  const hn::RebindToUnsigned<Tag<V>> u;
  const hn::RebindToSigned<Tag<V>> i;
  const auto bits = hn::BitCast(u, x);
  const auto biased =
      hn::ShiftRight<52>(hn::Add(bits, hn::Set(u, kOne - kRootHalf)));
  const V mantissa = hn::BitCast(
      d, hn::Sub(hn::Add(bits, hn::Set(u, kOne)), hn::ShiftLeft<52>(biased)));
  const V exponent = Less(hn::ConvertTo(d, hn::BitCast(i, biased)), 1023);
  const V one = hn::Set(d, 1);
  const V s = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
  return hn::Add(Times(std::numbers::ln2, exponent),
                 hn::Mul(Times(2, s), Horner(kAtanh, hn::Mul(s, s))));
}

// Uniform in [0, 1), as Random::Uniform().
template <class D, class V>
HWY_INLINE hn::Vec<D> ToUniform(D d, V bits) {
  const hn::RebindToSigned<D> i;
  return Times(0x1.0p-53,
               hn::ConvertTo(d, hn::BitCast(i, hn::ShiftRight<11>(bits))));
}

// `count`, a multiple of 16, random numbers as so many deviates.
void ToGaussian(const uint64_t* HWY_RESTRICT bits, size_t count,
                double* HWY_RESTRICT deviates) {
  constexpr hn::CappedTag<double, 8> d;
  constexpr hn::RebindToUnsigned<decltype(d)> u;
  using V = hn::Vec<decltype(d)>;
  for (size_t i = 0; i < count; i += 2 * hn::Lanes(d)) {
    hn::Vec<decltype(u)> firsts;
    hn::Vec<decltype(u)> seconds;
    hn::LoadInterleaved2(u, bits + i, firsts, seconds);
    const V square = OneMinus(ToUniform(d, firsts));
    const V turn = ToUniform(d, seconds);
    const V radius = hn::Sqrt(Times(-2, Logarithm(square)));
    // The angle is so many quarters and at most an eighth of a turn.
    const V quarters = Rounded(Times(4, turn));
    const V angle =
        Times(2 * std::numbers::pi, hn::Sub(turn, Times(0.25, quarters)));
    const V angle_square = hn::Mul(angle, angle);
    const V sine = hn::Mul(angle, Horner(kSine, angle_square));
    const V cosine = Horner(kCosine, angle_square);
    // 0 or 1: odd quarters swap the two.
    const V halves = Rounded(Less(Times(0.5, quarters), 0.25));
    const V odd = hn::Sub(quarters, Times(2, halves));
    const V even = OneMinus(odd);
    // Half turns change the sign.
    const V turns = Rounded(Less(Times(0.5, halves), 0.25));
    const V sign = OneMinus(Times(2, hn::Sub(halves, Times(2, turns))));
    const V signed_radius = hn::Mul(sign, radius);
    hn::StoreInterleaved2(hn::Mul(signed_radius, hn::Sub(hn::Mul(even, cosine),
                                                         hn::Mul(odd, sine))),
                          hn::Mul(signed_radius, hn::Add(hn::Mul(even, sine),
                                                         hn::Mul(odd, cosine))),
                          d, deviates + i);
  }
}

}  // namespace tactus::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(ToGaussian);

void FillGaussian(Random& random, std::span<double> deviates) {
  constexpr size_t kBlock = 128;
  std::array<uint64_t, kBlock> bits;
  while (deviates.size() >= kBlock) {
    random.Fill(bits);
    HWY_DYNAMIC_DISPATCH(ToGaussian)(bits.data(), kBlock, deviates.data());
    deviates = deviates.subspan(kBlock);
  }
  if (deviates.empty()) return;
  bits.fill(0);
  random.Fill(std::span(bits).first((deviates.size() + 1) / 2 * 2));
  std::array<double, kBlock> rest;
  HWY_DYNAMIC_DISPATCH(ToGaussian)(bits.data(), kBlock, rest.data());
  std::copy_n(rest.begin(), deviates.size(), deviates.begin());
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
