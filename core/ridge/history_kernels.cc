#include "core/ridge/history_kernels.h"

#include <algorithm>
#include <cmath>

#include "core/ridge/mini_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/ridge/history_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

// The compiler makes vectors of the plain loops.
HWY_BEFORE_NAMESPACE();
namespace tactus::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void AddChannels(const float* HWY_RESTRICT values, size_t count,
                 const ChannelSums& sums) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> f;
  const hn::RebindToUnsigned<decltype(f)> u;
  const auto one = hn::Set(u, 1);
  const auto short_weight = hn::Set(f, sums.short_weight);
  const auto long_weight = hn::Set(f, sums.long_weight);
  const auto add = [d](double* to, size_t i, auto x) {
    hn::StoreU(hn::Add(hn::LoadU(d, to + i), x), d, to + i);
  };
  const auto follow = [f](float* mean, size_t i, auto x, auto weight) {
    const auto before = hn::LoadU(f, mean + i);
    hn::StoreU(hn::Add(before, hn::Mul(weight, hn::Sub(x, before))), f,
               mean + i);
  };
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(f, values + i);
    const auto wide = hn::PromoteTo(d, x);
    add(sums.sum, i, wide);
    add(sums.block, i, wide);
    add(sums.square, i, hn::Mul(wide, wide));
    const auto step = hn::Abs(hn::Sub(x, hn::LoadU(f, sums.previous + i)));
    add(sums.steps, i, hn::PromoteTo(d, step));
    hn::StoreU(hn::Max(hn::LoadU(f, sums.largest + i), x), f, sums.largest + i);
    hn::StoreU(hn::Min(hn::LoadU(f, sums.smallest + i), x), f,
               sums.smallest + i);
    follow(sums.short_mean, i, x, short_weight);
    follow(sums.long_mean, i, x, long_weight);
    const auto is_active = hn::RebindMask(u, hn::Ne(x, hn::Zero(f)));
    hn::StoreU(hn::Add(hn::LoadU(u, sums.active + i),
                       hn::IfThenElseZero(is_active, one)),
               u, sums.active + i);
  }
}

void StepMiniKernels(const float* const* taps,
                     const float* HWY_RESTRICT thresholds,
                     float* HWY_RESTRICT values, uint32_t* HWY_RESTRICT above) {
  const hn::CappedTag<float, 8> d;
  static_assert(kMiniLanes % hn::MaxLanes(d) == 0);
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto one = hn::Set(du, 1);
  for (size_t k = 0; k < kMiniLanes; k += hn::Lanes(d)) {
    auto value = hn::Zero(d);
    for (int tap = 0; tap < kMiniTaps; ++tap) {
      value = hn::Add(value, hn::Mul(hn::LoadU(d, &kTaps.weight[tap][k]),
                                     hn::LoadU(d, taps[tap] + k)));
    }
    hn::StoreU(value, d, values + k);
    for (int t = 0; t < kMiniThresholds; ++t) {
      const size_t at = static_cast<size_t>(t) * kMiniLanes + k;
      const auto is_above =
          hn::RebindMask(du, hn::Gt(value, hn::LoadU(d, thresholds + at)));
      hn::StoreU(
          hn::Add(hn::LoadU(du, above + at), hn::IfThenElseZero(is_above, one)),
          du, above + at);
    }
  }
}

void AddScaled(float weight, const float* HWY_RESTRICT x, size_t count,
               float* HWY_RESTRICT mean) {
  for (size_t i = 0; i < count; ++i) mean[i] += weight * x[i];
}

void Standardise(const float* HWY_RESTRICT x, const float* HWY_RESTRICT offset,
                 const float* HWY_RESTRICT gain, float limit,
                 float* HWY_RESTRICT z, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const float scaled = (x[i] - offset[i]) * gain[i];
    const float below = scaled < limit ? scaled : limit;
    z[i] = below > -limit ? below : -limit;
  }
}

// The sum over all numbers of term(x, y), which takes two vectors or two
// numbers, in kDotStripes partial sums.
template <class Term>
float SumInStripes(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                   size_t count, const Term& term) {
  constexpr hn::CappedTag<float, 16> d;
  constexpr size_t kLanes = hn::MaxLanes(d);
  constexpr size_t kParts = kDotStripes / kLanes;
  decltype(hn::Zero(d)) parts[kParts];
  for (auto& part : parts) part = hn::Zero(d);
  size_t i = 0;
  for (; i + kDotStripes <= count; i += kDotStripes) {
    for (size_t p = 0; p < kParts; ++p) {
      const size_t at = i + p * kLanes;
      parts[p] =
          hn::Add(parts[p], term(hn::LoadU(d, x + at), hn::LoadU(d, y + at)));
    }
  }
  float sums[kDotStripes];
  for (size_t p = 0; p < kParts; ++p) {
    hn::StoreU(parts[p], d, sums + p * kLanes);
  }
  // The rest, with zeros behind it.
  float left_x[kDotStripes] = {};
  float left_y[kDotStripes] = {};
  std::copy(x + i, x + count, left_x);
  std::copy(y + i, y + count, left_y);
  for (size_t p = 0; p < kParts; ++p) {
    const size_t at = p * kLanes;
    hn::StoreU(
        hn::Add(hn::LoadU(d, sums + at),
                term(hn::LoadU(d, left_x + at), hn::LoadU(d, left_y + at))),
        d, sums + at);
  }
  for (size_t width = kDotStripes / 2; width > 0; width /= 2) {
    for (size_t s = 0; s < width; ++s) sums[s] += sums[s + width];
  }
  return sums[0];
}

float DotProduct(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                 size_t count) {
  return SumInStripes(x, y, count,
                      [](auto a, auto b) { return hn::Mul(a, b); });
}

float SquaredDistance(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                      size_t count) {
  return SumInStripes(x, y, count, [](auto a, auto b) {
    const auto apart = hn::Sub(a, b);
    return hn::Mul(apart, apart);
  });
}

}  // namespace tactus::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(AddChannels);
HWY_EXPORT(StepMiniKernels);
HWY_EXPORT(AddScaled);
HWY_EXPORT(Standardise);
HWY_EXPORT(DotProduct);
HWY_EXPORT(SquaredDistance);

void AddChannels(const float* values, size_t count, const ChannelSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddChannels)(values, count, sums);
}

void StepMiniKernels(const float* const* taps, const float* thresholds,
                     float* values, uint32_t* above) {
  HWY_DYNAMIC_DISPATCH(StepMiniKernels)(taps, thresholds, values, above);
}

void AddScaled(float weight, const float* x, size_t count, float* mean) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(weight, x, count, mean);
}

void Standardise(std::span<const float> x, std::span<const float> offset,
                 std::span<const float> gain, float limit, std::span<float> z) {
  HWY_DYNAMIC_DISPATCH(Standardise)
  (x.data(), offset.data(), gain.data(), limit, z.data(), x.size());
}

float DotProduct(std::span<const float> x, std::span<const float> y) {
  return HWY_DYNAMIC_DISPATCH(DotProduct)(x.data(), y.data(), x.size());
}

float SquaredDistance(std::span<const float> x, std::span<const float> y) {
  return HWY_DYNAMIC_DISPATCH(SquaredDistance)(x.data(), y.data(), x.size());
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
