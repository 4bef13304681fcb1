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

void MoveTowards(const float* taxels, size_t count, float weight,
                 float* means) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    hn::StoreU(
        Towards(d, hn::LoadU(d, means + i), Reading(d, taxels + i), weight), d,
        means + i);
  });
}

template <bool kMasked>
Felt StepValid(const float* HWY_RESTRICT taxels, size_t count, float weight,
               float reach, float background_weight, const Means& means) {
  const float* HWY_RESTRICT const valid_of = means.valid;
  const float* HWY_RESTRICT const background_of = means.background;
  float* HWY_RESTRICT const smooth_of = means.smooth;
  float* HWY_RESTRICT const moved = means.moved;
  float* HWY_RESTRICT const values = means.values;
  float* HWY_RESTRICT const differences = means.difference;
  Largest value_found;
  Largest difference_found;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto x = Reading(d, taxels + i);
    const auto far = hn::Set(d, reach);
    const auto smooth =
        hn::Clamp(Towards(d, hn::LoadU(d, smooth_of + i), x, weight),
                  hn::Sub(x, far), hn::Add(x, far));
    hn::StoreU(smooth, d, smooth_of + i);
    const auto background = hn::LoadU(d, background_of + i);
    hn::StoreU(Towards(d, background, x, background_weight), d, moved + i);
    auto value = hn::Max(hn::Zero(d), hn::Sub(x, background));
    auto difference = hn::Sub(smooth, background);
    if constexpr (kMasked) {
      const auto valid = hn::LoadU(d, valid_of + i);
      value = hn::Mul(valid, value);
      difference = hn::Mul(valid, difference);
    }
    hn::StoreU(value, d, values + i);
    hn::StoreU(difference, d, differences + i);
    value_found.Add(d, value);
    difference_found.Add(d, difference);
  });
  return {value_found.Result(), difference_found.Result()};
}

void StepMeans(const float* taxels, size_t count, float weight, float reach,
               float background_weight, const Means& means, Felt* felt) {
  *felt = means.valid == nullptr
              ? StepValid<false>(taxels, count, weight, reach,
                                 background_weight, means)
              : StepValid<true>(taxels, count, weight, reach, background_weight,
                                means);
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

// With `kTerms` above 0, that many terms.
template <int kTerms>
float SumTerms(const float* HWY_RESTRICT from, size_t count, size_t stride,
               int any_terms, float scale, float* HWY_RESTRICT sums) {
  const int terms = kTerms > 0 ? kTerms : any_terms;
  Largest largest;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    auto sum = hn::LoadU(d, from + i);
    for (int term = 1; term < terms; ++term) {
      sum = hn::Add(sum, hn::LoadU(d, from + i + term * stride));
    }
    sum = hn::Mul(sum, hn::Set(d, scale));
    hn::StoreU(sum, d, sums + i);
    largest.Add(d, sum);
  });
  return largest.Result();
}

float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums) {
  // The usual number, without a loop.
  if (terms == 3) return SumTerms<3>(from, count, stride, 3, scale, sums);
  return SumTerms<0>(from, count, stride, terms, scale, sums);
}

// Sums of three numbers along a row, for columns that begin at `column`.
template <class D>
HWY_INLINE hn::Vec<D> SumBeside(D d, const Grid& grid, int row, int column) {
  if (row < 0 || row >= grid.rows) return hn::Zero(d);
  const float* const first = grid.from + ptrdiff_t{row} * grid.columns;
  const float* const at = first + column;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(d));
  auto left = hn::LoadU(d, at - 1);
  if (column == 0) {
    left = hn::IfThenElse(hn::FirstN(d, 1),
                          hn::Set(d, grid.wrap ? first[grid.columns - 1] : 0),
                          left);
  }
  auto right = hn::LoadU(d, at + 1);
  if (column + kLanes == grid.columns) {
    right = hn::IfThenElse(hn::FirstN(d, kLanes - 1), right,
                           hn::Set(d, grid.wrap ? first[0] : 0));
  }
  return hn::Add(hn::Add(left, hn::LoadU(d, at)), right);
}

// Sums the vector of columns that begins at `column`, from row to row.
template <class D>
HWY_INLINE void SumStrip(D d, const Grid& grid, int column, int begin, int end,
                         float scale, float* sums, Largest* largest) {
  auto above = SumBeside(d, grid, begin - 1, column);
  auto here = SumBeside(d, grid, begin, column);
  auto most = hn::Zero(d);
  for (int row = begin; row < end; ++row) {
    const auto below = SumBeside(d, grid, row + 1, column);
    const auto sum =
        hn::Mul(hn::Add(hn::Add(above, here), below), hn::Set(d, scale));
    hn::StoreU(sum, d, sums + ptrdiff_t{row} * grid.columns + column);
    most = hn::Max(most, sum);
    above = here;
    here = below;
  }
  largest->Add(d, most);
}

// The last vector of a row may overlap the one before.
template <class D>
HWY_INLINE void SumStrips(D d, const Grid& grid, int begin, int end,
                          float scale, float* sums, Largest* largest) {
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(d));
  int column = 0;
  for (; column + kLanes <= grid.columns; column += kLanes) {
    SumStrip(d, grid, column, begin, end, scale, sums, largest);
  }
  if (column == grid.columns) return;
  constexpr int kHalf = kLanes > 1 ? kLanes / 2 : 1;
  if (grid.columns - column <= kHalf) {
    SumStrip(hn::CappedTag<float, kHalf>(), grid, grid.columns - kHalf, begin,
             end, scale, sums, largest);
  } else {
    SumStrip(d, grid, grid.columns - kLanes, begin, end, scale, sums, largest);
  }
}

float SumAround(const Grid& grid, int begin, int end, float scale,
                float* sums) {
  constexpr hn::CappedTag<float, kWidest> widest;
  constexpr hn::CappedTag<float, 4> narrow;
  Largest largest;
  if (grid.columns >= static_cast<int>(hn::MaxLanes(widest))) {
    SumStrips(widest, grid, begin, end, scale, sums, &largest);
  } else if (grid.columns >= static_cast<int>(hn::MaxLanes(narrow))) {
    SumStrips(narrow, grid, begin, end, scale, sums, &largest);
  } else {
    SumStrips(hn::CappedTag<float, 1>(), grid, begin, end, scale, sums,
              &largest);
  }
  return largest.Result();
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

void Learn(const float* background, size_t count, const float* mark_sums,
           const float* difference, float resting, float* moved, float* shape) {
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto marks = hn::LoadU(d, mark_sums + i);
    hn::StoreU(hn::IfThenElseZero(hn::Gt(marks, hn::Zero(d)),
                                  hn::LoadU(d, difference + i)),
               d, shape + i);
    const auto rests = hn::Ge(marks, hn::Set(d, resting));
    hn::StoreU(hn::IfThenElse(rests, hn::LoadU(d, background + i),
                              hn::LoadU(d, moved + i)),
               d, moved + i);
  });
}

}  // namespace tactus::light_touch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::light_touch {

HWY_EXPORT(MoveTowards);
HWY_EXPORT(StepMeans);
HWY_EXPORT(FindReached);
HWY_EXPORT(SumAlong);
HWY_EXPORT(SumAround);
HWY_EXPORT(Mark);
HWY_EXPORT(Learn);

void MoveTowards(std::span<const float> taxels, float weight, float* means) {
  HWY_DYNAMIC_DISPATCH(MoveTowards)
  (taxels.data(), taxels.size(), weight, means);
}

Felt StepMeans(std::span<const float> taxels, float weight, float reach,
               float background_weight, const Means& means) {
  Felt felt;
  HWY_DYNAMIC_DISPATCH(StepMeans)
  (taxels.data(), taxels.size(), weight, reach, background_weight, means,
   &felt);
  return felt;
}

Stretch FindReached(std::span<const float> numbers, float level) {
  Stretch found;
  HWY_DYNAMIC_DISPATCH(FindReached)
  (numbers.data(), numbers.size(), level, &found);
  return found;
}

float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums) {
  return HWY_DYNAMIC_DISPATCH(SumAlong)(from, count, stride, terms, scale,
                                        sums);
}

float SumAround(const Grid& grid, int begin, int end, float scale,
                float* sums) {
  return HWY_DYNAMIC_DISPATCH(SumAround)(grid, begin, end, scale, sums);
}

float Mark(std::span<const float> regions, const float* values,
           const Levels& levels, float* marks) {
  return HWY_DYNAMIC_DISPATCH(Mark)(regions.data(), regions.size(), values,
                                    levels, marks);
}

void Learn(std::span<const float> background, const float* mark_sums,
           const float* difference, float resting, float* moved, float* shape) {
  HWY_DYNAMIC_DISPATCH(Learn)
  (background.data(), background.size(), mark_sums, difference, resting, moved,
   shape);
}

}  // namespace tactus::light_touch
#endif  // HWY_ONCE
