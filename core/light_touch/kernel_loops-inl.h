// File: kernel_loops-inl.h
//
// The loops of the kernels of light touch: over all taxels, and over the
// columns of one row. Highway includes this file once per instruction set.
//
//   Largest largest;
//   ForEach(count, [&](auto d, size_t i) HWY_ATTR {
//     largest.Add(d, hn::LoadU(d, taxels + i));
//   });
//
// Thread-safe: free functions.
#if defined(TACTUS_CORE_LIGHT_TOUCH_KERNEL_LOOPS_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef TACTUS_CORE_LIGHT_TOUCH_KERNEL_LOOPS_INL_H_
#undef TACTUS_CORE_LIGHT_TOUCH_KERNEL_LOOPS_INL_H_
#else
#define TACTUS_CORE_LIGHT_TOUCH_KERNEL_LOOPS_INL_H_
#endif

#include <cstddef>

#include "core/light_touch/light_touch_kernels.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::light_touch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kWidest = 16;

// Runs step(d, i) for the widest vectors, then for one of half their width,
// then one by one.
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

// Runs strip(d, column) for vectors that together have all columns of a row.
// Two of them may overlap.
template <class Strip>
HWY_INLINE void ForEachStrip(size_t columns, const Strip& strip) {
  const auto run = [&](auto d) HWY_ATTR {
    constexpr size_t kLanes = hn::MaxLanes(d);
    size_t column = 0;
    for (; column + kLanes <= columns; column += kLanes) strip(d, column);
    if (column == columns) return;
    constexpr size_t kHalf = kLanes > 1 ? kLanes / 2 : 1;
    if (columns - column <= kHalf) {
      strip(hn::CappedTag<float, kHalf>(), columns - kHalf);
    } else {
      strip(d, columns - kLanes);
    }
  };
  constexpr hn::CappedTag<float, kWidest> wide;
  constexpr hn::CappedTag<float, 4> narrow;
  if (columns >= hn::MaxLanes(wide)) {
    run(wide);
  } else if (columns >= hn::MaxLanes(narrow)) {
    run(narrow);
  } else {
    run(hn::CappedTag<float, 1>());
  }
}

// Sum and difference on the units of the CPU that multiply, which have little
// to do here. The bits are those of hn::Add and hn::Sub.
template <class D>
HWY_INLINE hn::Vec<D> AddByProduct(D d, hn::Vec<D> a, hn::Vec<D> b) {
  return hn::MulAdd(hn::Set(d, 1.0F), a, b);
}
template <class D>
HWY_INLINE hn::Vec<D> SubByProduct(D d, hn::Vec<D> a, hn::Vec<D> b) {
  return hn::MulSub(hn::Set(d, 1.0F), a, b);
}

// Means approach this, not 0, above a taxel that reads 0: numbers near 0 are
// slow to compute with.
constexpr float kAlmostZero = 1e-20F;

template <class D>
HWY_INLINE hn::Vec<D> Reading(D d, const float* taxel) {
  return AddByProduct(d, hn::LoadU(d, taxel), hn::Set(d, kAlmostZero));
}

// taxel - background of valid taxels, else 0.
template <bool kMasked, class D>
HWY_INLINE hn::Vec<D> Value(D d, const Readings& readings, size_t i) {
  const auto value = hn::Sub(Reading(d, readings.taxels + i),
                             hn::LoadU(d, readings.background + i));
  if constexpr (!kMasked) return value;
  return hn::Mul(hn::LoadU(d, readings.valid + i), value);
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

}  // namespace tactus::internal::light_touch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
