#include "core/light_touch/light_touch_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/light_touch/light_touch_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

// After foreach_target.h.
#include "core/light_touch/kernel_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::light_touch::HWY_NAMESPACE {

// A mean that is `away` from its taxel, moved towards it.
template <class D>
HWY_INLINE hn::Vec<D> Moved(D d, hn::Vec<D> mean, hn::Vec<D> away,
                            float weight) {
  return AddByProduct(d, hn::Mul(hn::Set(d, weight), away), mean);
}

void MoveTowards(const float* taxels, size_t count, float weight, float* smooth,
                 float background_weight, float* background) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto x = Reading(d, taxels + i);
    const auto mean = hn::LoadU(d, smooth + i);
    hn::StoreU(Moved(d, mean, hn::Sub(x, mean), weight), d, smooth + i);
    const auto slow = hn::LoadU(d, background + i);
    hn::StoreU(Moved(d, slow, hn::Sub(x, slow), background_weight), d,
               background + i);
  });
}

template <bool kMasked>
float StepValid(const float* HWY_RESTRICT taxels, size_t count, float weight,
                float reach, float background_weight, const Means& means) {
  const float* HWY_RESTRICT const valid_of = means.valid;
  const float* HWY_RESTRICT const background_of = means.background;
  float* HWY_RESTRICT const smooth_of = means.smooth;
  float* HWY_RESTRICT const moved = means.moved;
  float* HWY_RESTRICT const differences = means.difference;
  Largest value_found;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto x = Reading(d, taxels + i);
    const auto far = hn::Set(d, reach);
    const auto mean = hn::LoadU(d, smooth_of + i);
    const auto smooth = hn::Clamp(Moved(d, mean, hn::Sub(x, mean), weight),
                                  hn::Sub(x, far), AddByProduct(d, x, far));
    hn::StoreU(smooth, d, smooth_of + i);
    const auto background = hn::LoadU(d, background_of + i);
    auto value = SubByProduct(d, x, background);
    hn::StoreU(Moved(d, background, value, background_weight), d, moved + i);
    auto difference = hn::Sub(smooth, background);
    if constexpr (kMasked) {
      const auto valid = hn::LoadU(d, valid_of + i);
      value = hn::Mul(valid, value);
      difference = hn::Mul(valid, difference);
    }
    hn::StoreU(difference, d, differences + i);
    value_found.Add(d, value);
  });
  return value_found.Result();
}

float StepMeans(const float* taxels, size_t count, float weight, float reach,
                float background_weight, const Means& means) {
  return means.valid == nullptr ? StepValid<false>(taxels, count, weight, reach,
                                                   background_weight, means)
                                : StepValid<true>(taxels, count, weight, reach,
                                                  background_weight, means);
}

void FindReached(const float* numbers, size_t count, float level,
                 Stretch* found) {
  constexpr hn::CappedTag<float, kWidest> d;
  constexpr size_t kLanes = hn::MaxLanes(d);
  const auto reach = [&](size_t i) HWY_ATTR {
    return !hn::AllFalse(d,
                         hn::Ge(hn::LoadU(d, numbers + i), hn::Set(d, level)));
  };
  size_t begin = 0;
  while (begin + kLanes <= count && !reach(begin)) begin += kLanes;
  if (begin + kLanes > count) {
    while (begin < count && !(numbers[begin] >= level)) ++begin;
    if (begin == count) {
      *found = {};
      return;
    }
  }
  size_t end = count;
  while (end >= begin + kLanes && !reach(end - kLanes)) end -= kLanes;
  if (end < begin + kLanes) {
    while (!(numbers[end - 1] >= level)) --end;
  }
  *found = {begin, end};
}

void FindNear(const uint64_t* HWY_RESTRICT marks, size_t rows,
              Surroundings around, uint64_t* HWY_RESTRICT near) {
  constexpr hn::CappedTag<uint64_t, 8> d;
  const auto all = hn::Set(d, ~uint64_t{0} >> (64 - around.columns));
  for (size_t row = 0; row < rows; row += hn::MaxLanes(d)) {
    auto marked = hn::LoadU(d, marks + row);
    for (int i = 1; i <= around.above; ++i) {
      marked = hn::Or(marked, hn::LoadU(d, marks + row - i));
    }
    for (int i = 1; i <= around.below; ++i) {
      marked = hn::Or(marked, hn::LoadU(d, marks + row + i));
    }
    auto found = marked;
    for (int i = 1; i <= around.left; ++i) {
      found = hn::Or(found, hn::ShiftLeftSame(marked, i));
      if (!around.wrap) continue;
      found = hn::Or(found, hn::ShiftRightSame(marked, around.columns - i));
    }
    for (int i = 1; i <= around.right; ++i) {
      found = hn::Or(found, hn::ShiftRightSame(marked, i));
      if (!around.wrap) continue;
      found = hn::Or(found, hn::ShiftLeftSame(marked, around.columns - i));
    }
    hn::StoreU(hn::And(found, all), d, near + row);
  }
}

template <class D>
HWY_INLINE hn::Mask<D> LanesOf(D d, uint64_t bits, size_t column) {
  bits >>= column;
  return hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&bits));
}

template <bool kMasked>
void LearnValid(Rows rows, Readings readings, Near near,
                float* HWY_RESTRICT moved, float* HWY_RESTRICT values,
                float* HWY_RESTRICT shape) {
  ForEachStrip(rows.columns, [&](auto d, size_t column) HWY_ATTR {
    size_t i = column;
    for (size_t row = 0; row < rows.rows; ++row, i += rows.columns) {
      hn::StoreU(hn::Max(hn::Zero(d), Value<kMasked>(d, readings, i)), d,
                 values + i);
      hn::StoreU(hn::IfThenElseZero(LanesOf(d, near.felt[row], column),
                                    hn::LoadU(d, near.difference + i)),
                 d, shape + i);
      hn::StoreU(hn::IfThenElse(LanesOf(d, near.touched[row], column),
                                hn::LoadU(d, readings.background + i),
                                hn::LoadU(d, moved + i)),
                 d, moved + i);
    }
  });
}

void Learn(const Rows& rows, const Readings& readings, const Near& near,
           float* moved, float* values, float* shape) {
  if (readings.valid == nullptr) {
    LearnValid<false>(rows, readings, near, moved, values, shape);
  } else {
    LearnValid<true>(rows, readings, near, moved, values, shape);
  }
}

}  // namespace tactus::internal::light_touch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal::light_touch {

HWY_EXPORT(MoveTowards);
HWY_EXPORT(StepMeans);
HWY_EXPORT(FindReached);
HWY_EXPORT(FindNear);
HWY_EXPORT(Learn);

void MoveTowards(std::span<const float> taxels, float weight, float* smooth,
                 float background_weight, float* background) {
  HWY_DYNAMIC_DISPATCH(MoveTowards)
  (taxels.data(), taxels.size(), weight, smooth, background_weight, background);
}

float StepMeans(std::span<const float> taxels, float weight, float reach,
                float background_weight, const Means& means) {
  return HWY_DYNAMIC_DISPATCH(StepMeans)(taxels.data(), taxels.size(), weight,
                                         reach, background_weight, means);
}

Stretch FindReached(std::span<const float> numbers, float level) {
  Stretch found;
  HWY_DYNAMIC_DISPATCH(FindReached)
  (numbers.data(), numbers.size(), level, &found);
  return found;
}

void FindNear(const uint64_t* marks, size_t rows,
              const Surroundings& surroundings, uint64_t* near) {
  HWY_DYNAMIC_DISPATCH(FindNear)(marks, rows, surroundings, near);
}

void Learn(const Rows& rows, const Readings& readings, const Near& near,
           float* moved, float* values, float* shape) {
  HWY_DYNAMIC_DISPATCH(Learn)(rows, readings, near, moved, values, shape);
}

}  // namespace tactus::internal::light_touch
#endif  // HWY_ONCE
