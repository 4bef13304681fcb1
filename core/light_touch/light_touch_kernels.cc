#include "core/light_touch/light_touch_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/light_touch/light_touch_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::light_touch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Means approach this, not 0, above a taxel that reads 0: numbers near 0 are
// slow to compute with.
constexpr float kAlmostZero = 1e-20F;

// Runs step(d, i) for the widest vectors, then for one of half their width,
// then one by one.
constexpr size_t kWidest = 16;
template <class Step>
HWY_INLINE void ForEach(size_t count, const Step& step) {
  constexpr hn::CappedTag<float, kWidest> d;
  constexpr size_t kLanes = hn::MaxLanes(d);
  size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) step(d, i);
  constexpr size_t kHalf = kLanes > 1 ? kLanes / 2 : 1;
  if (i + kHalf <= count) {
    step(hn::CappedTag<float, kHalf>(), i);
    i += kHalf;
  }
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

// The largest lane that was added, and at least 0.
class Largest {
 public:
  HWY_INLINE Largest() : widest_(hn::Zero(Wide())) {}

  template <class D>
  HWY_INLINE void Add(D d, hn::Vec<D> x) {
    if constexpr (hn::MaxLanes(d) == hn::MaxLanes(Wide())) {
      widest_ = hn::Max(widest_, x);
    } else {
      Raise(d, x);
    }
  }
  HWY_INLINE float Result() {
    Raise(Wide(), widest_);
    return rest_;
  }

 private:
  using Wide = hn::CappedTag<float, kWidest>;

  template <class D>
  HWY_INLINE void Raise(D d, hn::Vec<D> x) {
    const float lane = hn::GetLane(hn::MaxOfLanes(d, x));
    rest_ = lane > rest_ ? lane : rest_;
  }

  hn::Vec<Wide> widest_;
  float rest_ = 0;
};

// Where numbers reached a level. Without branches: noise about the level would
// make them unpredictable.
class Reached {
 public:
  template <class D>
  HWY_INLINE void Add(D d, size_t i, hn::Vec<D> x, float level) {
    const size_t any =
        size_t{0} - !hn::AllFalse(d, hn::Ge(x, hn::Set(d, level)));
    const size_t begin = i | ~any;
    const size_t end = (i + hn::MaxLanes(d)) & any;
    begin_ = begin < begin_ ? begin : begin_;
    end_ = end > end_ ? end : end_;
  }
  HWY_INLINE Stretch Result() const { return {end_ == 0 ? 0 : begin_, end_}; }

 private:
  size_t begin_ = ~size_t{0};
  size_t end_ = 0;
};

void MoveTowards(const float* taxels, size_t count, float weight,
                 float* means) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    hn::StoreU(
        Towards(d, hn::LoadU(d, means + i), Reading(d, taxels + i), weight), d,
        means + i);
  });
}

void StepMeans(const float* HWY_RESTRICT taxels, size_t count, float weight,
               float reach, float difference_level, float value_level,
               Means means, Felt* felt) {
  const float* HWY_RESTRICT const valid_of = means.valid;
  const float* HWY_RESTRICT const background_of = means.background;
  float* HWY_RESTRICT const smooth_of = means.smooth;
  float* HWY_RESTRICT const values = means.values;
  float* HWY_RESTRICT const differences = means.difference;
  Largest largest;
  Reached different;
  Reached strong;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto x = Reading(d, taxels + i);
    const auto far = hn::Set(d, reach);
    const auto smooth =
        hn::Clamp(Towards(d, hn::LoadU(d, smooth_of + i), x, weight),
                  hn::Sub(x, far), hn::Add(x, far));
    hn::StoreU(smooth, d, smooth_of + i);
    const auto valid = hn::LoadU(d, valid_of + i);
    const auto background = hn::LoadU(d, background_of + i);
    const auto value =
        hn::Mul(valid, hn::Max(hn::Zero(d), hn::Sub(x, background)));
    hn::StoreU(value, d, values + i);
    const auto difference = hn::Mul(valid, hn::Sub(smooth, background));
    hn::StoreU(difference, d, differences + i);
    largest.Add(d, value);
    different.Add(d, i, difference, difference_level);
    strong.Add(d, i, value, value_level);
  });
  *felt = {largest.Result(), different.Result(), strong.Result()};
}

// With `kTerms` above 0, that many terms.
template <int kTerms>
void SumTerms(const float* HWY_RESTRICT from, size_t count, size_t stride,
              int any_terms, float scale, float level, float* HWY_RESTRICT sums,
              Sums* result) {
  const int terms = kTerms > 0 ? kTerms : any_terms;
  Largest largest;
  Reached loud;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    auto sum = hn::LoadU(d, from + i);
    for (int term = 1; term < terms; ++term) {
      sum = hn::Add(sum, hn::LoadU(d, from + i + term * stride));
    }
    sum = hn::Mul(sum, hn::Set(d, scale));
    hn::StoreU(sum, d, sums + i);
    largest.Add(d, sum);
    loud.Add(d, i, sum, level);
  });
  *result = {largest.Result(), loud.Result()};
}

void SumAlong(const float* from, size_t count, size_t stride, int terms,
              float scale, float level, float* sums, Sums* result) {
  // The usual number, without a loop.
  if (terms == 3) {
    return SumTerms<3>(from, count, stride, 3, scale, level, sums, result);
  }
  SumTerms<0>(from, count, stride, terms, scale, level, sums, result);
}

float Mark(const float* regions, size_t count, const float* values,
           const Levels& levels, float* marks) {
  Largest largest;
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
    largest.Add(d, mark);
  });
  return largest.Result();
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

Felt StepMeans(std::span<const float> taxels, float weight, float reach,
               float difference, float value, const Means& means) {
  Felt felt;
  HWY_DYNAMIC_DISPATCH(StepMeans)
  (taxels.data(), taxels.size(), weight, reach, difference, value, means,
   &felt);
  return felt;
}

Sums SumAlong(const float* from, size_t count, size_t stride, int terms,
              float scale, float level, float* sums) {
  Sums result;
  HWY_DYNAMIC_DISPATCH(SumAlong)
  (from, count, stride, terms, scale, level, sums, &result);
  return result;
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
