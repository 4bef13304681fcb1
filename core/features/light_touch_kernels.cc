#include "core/features/light_touch_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/features/light_touch_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::light_touch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Means approach this, not 0, above a taxel that reads 0: numbers near 0 are
// slow to compute with.
constexpr float kAlmostZero = 1e-20F;

// Runs step(d, i) for i = 0, lanes, ...; the rest one by one.
template <class Step>
HWY_INLINE void ForEach(size_t count, const Step& step) {
  constexpr hn::CappedTag<float, 8> d;
  size_t i = 0;
  for (; i + hn::MaxLanes(d) <= count; i += hn::MaxLanes(d)) step(d, i);
  for (; i < count; ++i) step(hn::CappedTag<float, 1>(), i);
}

template <class D>
HWY_INLINE hn::Vec<D> Towards(D d, hn::Vec<D> mean, hn::Vec<D> x,
                              float weight) {
  return hn::Add(mean, hn::Mul(hn::Set(d, weight), hn::Sub(x, mean)));
}

template <class D>
HWY_INLINE hn::Vec<D> Reading(D d, const float* taxel) {
  return hn::Add(hn::LoadU(d, taxel), hn::Set(d, kAlmostZero));
}

// The larger of `so_far` and the lanes of `x`.
template <class D>
HWY_INLINE void Raise(D d, hn::Vec<D> x, float* so_far) {
  float lanes[hn::MaxLanes(d)];
  hn::StoreU(x, d, lanes);
  for (const float lane : lanes) *so_far = lane > *so_far ? lane : *so_far;
}

void MoveTowards(const float* taxels, size_t count, float weight,
                 float* means) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    hn::StoreU(
        Towards(d, hn::LoadU(d, means + i), Reading(d, taxels + i), weight), d,
        means + i);
  });
}

float StepMeans(const float* taxels, size_t count, float weight, float reach,
                const Means& means) {
  float peak = 0;
  constexpr hn::CappedTag<float, 8> wide;
  auto largest = hn::Zero(wide);
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto x = Reading(d, taxels + i);
    const auto far = hn::Set(d, reach);
    const auto smooth =
        hn::Clamp(Towards(d, hn::LoadU(d, means.smooth + i), x, weight),
                  hn::Sub(x, far), hn::Add(x, far));
    hn::StoreU(smooth, d, means.smooth + i);
    const auto valid = hn::LoadU(d, means.valid + i);
    const auto background = hn::LoadU(d, means.background + i);
    const auto value =
        hn::Mul(valid, hn::Max(hn::Zero(d), hn::Sub(x, background)));
    hn::StoreU(value, d, means.values + i);
    hn::StoreU(hn::Mul(valid, hn::Sub(smooth, background)), d,
               means.difference + i);
    if constexpr (hn::MaxLanes(d) == hn::MaxLanes(wide)) {
      largest = hn::Max(largest, value);
    } else {
      Raise(d, value, &peak);
    }
  });
  Raise(wide, largest, &peak);
  return peak;
}

// With `kTerms` above 0, that many terms.
template <int kTerms>
float SumTerms(const float* from, size_t count, size_t stride, int any_terms,
               float scale, float* sums) {
  const int terms = kTerms > 0 ? kTerms : any_terms;
  float peak = 0;
  constexpr hn::CappedTag<float, 8> wide;
  auto largest = hn::Zero(wide);
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    auto sum = hn::LoadU(d, from + i);
    for (int term = 1; term < terms; ++term) {
      sum = hn::Add(sum, hn::LoadU(d, from + i + term * stride));
    }
    sum = hn::Mul(sum, hn::Set(d, scale));
    hn::StoreU(sum, d, sums + i);
    if constexpr (hn::MaxLanes(d) == hn::MaxLanes(wide)) {
      largest = hn::Max(largest, sum);
    } else {
      Raise(d, sum, &peak);
    }
  });
  Raise(wide, largest, &peak);
  return peak;
}

float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums) {
  // The usual number, without a loop.
  if (terms == 3) return SumTerms<3>(from, count, stride, 3, scale, sums);
  return SumTerms<0>(from, count, stride, terms, scale, sums);
}

float Mark(const float* regions, size_t count, const float* values,
           const Levels& levels, float* marks) {
  float peak = 0;
  constexpr hn::CappedTag<float, 8> wide;
  auto largest = hn::Zero(wide);
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto region = hn::LoadU(d, regions + i);
    const auto felt = hn::Ge(region, hn::Set(d, levels.contact));
    const auto begins =
        hn::Or(hn::Ge(region, hn::Set(d, levels.begin)),
               hn::Ge(hn::LoadU(d, values + i), hn::Set(d, levels.strong)));
    const auto was = hn::Ge(hn::LoadU(d, marks + i), hn::Set(d, kTouchedMark));
    const auto mark = hn::IfThenElse(
        hn::Or(begins, hn::And(was, felt)), hn::Set(d, kTouchedMark),
        hn::IfThenElseZero(felt, hn::Set(d, kFeltMark)));
    hn::StoreU(mark, d, marks + i);
    if constexpr (hn::MaxLanes(d) == hn::MaxLanes(wide)) {
      largest = hn::Max(largest, mark);
    } else {
      Raise(d, mark, &peak);
    }
  });
  Raise(wide, largest, &peak);
  return peak;
}

void Learn(const float* taxels, size_t count, const float* mark_sums,
           const float* difference, float weight, float resting,
           float* background, float* shape) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto marks = hn::LoadU(d, mark_sums + i);
    hn::StoreU(hn::IfThenElseZero(hn::Gt(marks, hn::Zero(d)),
                                  hn::LoadU(d, difference + i)),
               d, shape + i);
    const auto mean = hn::LoadU(d, background + i);
    const auto moved = Towards(d, mean, Reading(d, taxels + i), weight);
    const auto rests = hn::Ge(marks, hn::Set(d, resting));
    hn::StoreU(hn::IfThenElse(rests, mean, moved), d, background + i);
  });
}

}  // namespace tactus::light_touch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::light_touch {

HWY_EXPORT(MoveTowards);
HWY_EXPORT(StepMeans);
HWY_EXPORT(SumAlong);
HWY_EXPORT(Mark);
HWY_EXPORT(Learn);

void MoveTowards(std::span<const float> taxels, float weight, float* means) {
  HWY_DYNAMIC_DISPATCH(MoveTowards)
  (taxels.data(), taxels.size(), weight, means);
}

float StepMeans(std::span<const float> taxels, float weight, float reach,
                const Means& means) {
  return HWY_DYNAMIC_DISPATCH(StepMeans)(taxels.data(), taxels.size(), weight,
                                         reach, means);
}

float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums) {
  return HWY_DYNAMIC_DISPATCH(SumAlong)(from, count, stride, terms, scale,
                                        sums);
}

float Mark(std::span<const float> regions, const float* values,
           const Levels& levels, float* marks) {
  return HWY_DYNAMIC_DISPATCH(Mark)(regions.data(), regions.size(), values,
                                    levels, marks);
}

void Learn(std::span<const float> taxels, const float* mark_sums,
           const float* difference, float weight, float resting,
           float* background, float* shape) {
  HWY_DYNAMIC_DISPATCH(Learn)
  (taxels.data(), taxels.size(), mark_sums, difference, weight, resting,
   background, shape);
}

}  // namespace tactus::light_touch
#endif  // HWY_ONCE
