#include "core/light_touch/region_kernels.h"

#include "core/base/limits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/light_touch/region_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

// After foreach_target.h.
#include "core/light_touch/kernel_loops-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::light_touch::HWY_NAMESPACE {

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

// A vector of columns of a grid. With kWrap the grid's last column is a
// neighbour of the first.
template <bool kWrap, class D>
class Strip {
 public:
  using V = hn::Vec<D>;

  HWY_INLINE Strip(D d, const Grid& grid, size_t column)
      : from_(grid.from),
        columns_(grid.columns),
        column_(static_cast<ptrdiff_t>(column)),
        first_column_(hn::FirstN(d, column == 0 ? 1 : 0)),
        before_last_(hn::FirstN(
            d, column_ + kLanes == columns_ ? kLanes - 1 : kLanes)) {}

  // Runs step(row, sums of the 3 x 3 numbers around the row's) for rows.
  template <class Step>
  HWY_INLINE void ForEachRow(int rows, int begin, int end, const Step& step) {
    SumRows<true, true>(rows, begin, end, step);
  }

  // The same, faster for steps so short that compilers inline them everywhere.
  template <class Step>
  HWY_INLINE void ForEachRowOfEnds(int rows, int begin, int end,
                                   const Step& step) {
    const bool at_left = column_ == 0;
    const bool at_right = column_ + kLanes == columns_;
    // Most vectors are at one end of their rows.
    if (at_left && !at_right) {
      SumRows<true, false>(rows, begin, end, step);
    } else if (at_right && !at_left) {
      SumRows<false, true>(rows, begin, end, step);
    } else {
      SumRows<true, true>(rows, begin, end, step);
    }
  }

 private:
  static constexpr ptrdiff_t kLanes = hn::MaxLanes(D());

  template <bool kAtLeft, bool kAtRight, class Step>
  HWY_INLINE void SumRows(int rows, int begin, int end, const Step& step) {
    const auto beside = [&](int row) HWY_ATTR {
      return SumBeside<kAtLeft, kAtRight>(row);
    };
    V above = begin > 0 ? beside(begin - 1) : hn::Zero(D());
    V here = beside(begin);
    const int last = rows - 1;
    for (int row = begin; row < (end < last ? end : last); ++row) {
      const V below = beside(row + 1);
      step(row, hn::Add(AddByProduct(D(), above, here), below));
      above = here;
      here = below;
    }
    if (end == rows) step(last, hn::Add(above, here));
  }

  // Sums of three numbers along a row, of a vector that may be at its ends.
  template <bool kAtLeft, bool kAtRight>
  HWY_INLINE V SumBeside(int row) const {
    constexpr D d;
    const float* const first = from_ + row * columns_;
    const float* const at = first + column_;
    V left = hn::LoadU(d, at - 1);
    V right = hn::LoadU(d, at + 1);
    if constexpr (kAtLeft && kWrap) {
      left =
          hn::IfThenElse(first_column_, hn::Set(d, first[columns_ - 1]), left);
    } else if constexpr (kAtLeft) {
      left = hn::IfThenZeroElse(first_column_, left);
    }
    if constexpr (kAtRight && kWrap) {
      right = hn::IfThenElse(before_last_, right, hn::Set(d, first[0]));
    } else if constexpr (kAtRight) {
      right = hn::IfThenElseZero(before_last_, right);
    }
    return hn::Add(AddByProduct(d, left, hn::LoadU(d, at)), right);
  }

  const float* HWY_RESTRICT from_;
  ptrdiff_t columns_;
  ptrdiff_t column_;
  // The lane of the row's first column, if there is one; the lanes of all
  // columns but the row's last one.
  hn::Mask<D> first_column_;
  hn::Mask<D> before_last_;
};

template <bool kWrap>
float SumSquares(Grid grid, int begin, int end, float scale,
                 float* HWY_RESTRICT sums) {
  Largest largest;
  ForEachStrip(grid.columns, [&](auto d, size_t column) HWY_ATTR {
    auto most = hn::Zero(d);
    float* HWY_RESTRICT const to = sums + column;
    Strip<kWrap, decltype(d)>(d, grid, column)
        .ForEachRow(grid.rows, begin, end, [&](int row, auto sum) HWY_ATTR {
          sum = hn::Mul(sum, hn::Set(d, scale));
          hn::StoreU(sum, d, to + ptrdiff_t{row} * grid.columns);
          most = hn::Max(most, sum);
        });
    largest.Add(d, most);
  });
  return largest.Result();
}

float SumAround(const Grid& grid, int begin, int end, float scale,
                float* sums) {
  return grid.wrap ? SumSquares<true>(grid, begin, end, scale, sums)
                   : SumSquares<false>(grid, begin, end, scale, sums);
}

template <bool kWrap>
float LargestSquare(Grid grid, int begin, int end) {
  Largest largest;
  ForEachStrip(grid.columns, [&](auto d, size_t column) HWY_ATTR {
    auto most = hn::Zero(d);
    Strip<kWrap, decltype(d)>(d, grid, column)
        .ForEachRow(grid.rows, begin, end,
                    [&](int, auto sum) HWY_ATTR { most = hn::Max(most, sum); });
    largest.Add(d, most);
  });
  return largest.Result();
}

float LargestAround(const Grid& grid, int begin, int end, float scale) {
  // The product of the largest sum is the largest product.
  return scale * (grid.wrap ? LargestSquare<true>(grid, begin, end)
                            : LargestSquare<false>(grid, begin, end));
}

// The lanes of a vector that begins at `column`, as bits of their columns.
template <class D>
HWY_INLINE uint64_t BitsOf(D d, hn::Mask<D> lanes, size_t column) {
  uint64_t bits = 0;
  hn::StoreMaskBits(d, lanes, reinterpret_cast<uint8_t*>(&bits));
  return bits << column;
}

// Sets the bits of a vector's taxels whose regions are at `contact`, and of
// those that begin to be touched.
template <bool kMasked, class D>
HWY_INLINE void MarkRow(D d, hn::Vec<D> region, const Readings& readings,
                        const Levels& levels, size_t i, size_t column,
                        uint64_t* HWY_RESTRICT contact,
                        uint64_t* HWY_RESTRICT begin) {
  const auto begins =
      hn::Or(hn::Ge(region, hn::Set(d, levels.begin)),
             hn::Ge(Value<kMasked>(d, readings, i), hn::Set(d, levels.strong)));
  *contact |= BitsOf(d, hn::Ge(region, hn::Set(d, levels.contact)), column);
  *begin |= BitsOf(d, begins, column);
}

// Runs strips(contact, begin), which sets bits of rows begin .. end-1, and
// makes marks of them.
template <class Strips>
HWY_INLINE void MarkRows(int begin, int end, const Marks& marks,
                         const Strips& strips) {
  uint64_t contact[limits::kMaxRows];
  uint64_t begins[limits::kMaxRows];
  for (int row = begin; row < end; ++row) contact[row] = begins[row] = 0;
  strips(contact, begins);
  for (int row = begin; row < end; ++row) {
    const uint64_t touched = begins[row] | (marks.touched[row] & contact[row]);
    marks.touched[row] = touched;
    marks.felt[row] = touched | contact[row];
  }
}

template <bool kWrap, bool kMasked>
float MarkSquares(Grid grid, int begin, int end, float scale, Readings readings,
                  Levels levels, Marks marks) {
  Largest largest;
  MarkRows(begin, end, marks,
           [&](uint64_t* contact, uint64_t* begins) HWY_ATTR {
             ForEachStrip(grid.columns, [&](auto d, size_t column) HWY_ATTR {
               auto most = hn::Zero(d);
               Strip<kWrap, decltype(d)>(d, grid, column)
                   .ForEachRow(
                       grid.rows, begin, end, [&](int row, auto sum) HWY_ATTR {
                         sum = hn::Mul(sum, hn::Set(d, scale));
                         most = hn::Max(most, sum);
                         MarkRow<kMasked>(d, sum, readings, levels,
                                          size_t(row) * grid.columns + column,
                                          column, contact + row, begins + row);
                       });
               largest.Add(d, most);
             });
           });
  return largest.Result();
}

template <bool kMasked>
float MarkMasked(const Grid& grid, int begin, int end, float scale,
                 const Readings& readings, const Levels& levels,
                 const Marks& marks) {
  return grid.wrap ? MarkSquares<true, kMasked>(grid, begin, end, scale,
                                                readings, levels, marks)
                   : MarkSquares<false, kMasked>(grid, begin, end, scale,
                                                 readings, levels, marks);
}

float MarkAround(const Grid& grid, int begin, int end, float scale,
                 const Readings& readings, const Levels& levels,
                 const Marks& marks) {
  return readings.valid == nullptr ? MarkMasked<false>(grid, begin, end, scale,
                                                       readings, levels, marks)
                                   : MarkMasked<true>(grid, begin, end, scale,
                                                      readings, levels, marks);
}

template <bool kMasked>
void MarkWritten(Grid sums, int begin, int end, Readings readings,
                 Levels levels, Marks marks) {
  MarkRows(
      begin, end, marks, [&](uint64_t* contact, uint64_t* begins) HWY_ATTR {
        ForEachStrip(sums.columns, [&](auto d, size_t column) HWY_ATTR {
          for (int row = begin; row < end; ++row) {
            const size_t i = size_t(row) * sums.columns + column;
            MarkRow<kMasked>(d, hn::LoadU(d, sums.from + i), readings, levels,
                             i, column, contact + row, begins + row);
          }
        });
      });
}

void MarkSums(const Grid& sums, int begin, int end, const Readings& readings,
              const Levels& levels, const Marks& marks) {
  if (readings.valid == nullptr) {
    MarkWritten<false>(sums, begin, end, readings, levels, marks);
  } else {
    MarkWritten<true>(sums, begin, end, readings, levels, marks);
  }
}

}  // namespace tactus::internal::light_touch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal::light_touch {

HWY_EXPORT(SumAlong);
HWY_EXPORT(SumAround);
HWY_EXPORT(LargestAround);
HWY_EXPORT(MarkAround);
HWY_EXPORT(MarkSums);

float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums) {
  return HWY_DYNAMIC_DISPATCH(SumAlong)(from, count, stride, terms, scale,
                                        sums);
}

float SumAround(const Grid& grid, int begin, int end, float scale,
                float* sums) {
  return HWY_DYNAMIC_DISPATCH(SumAround)(grid, begin, end, scale, sums);
}

float LargestAround(const Grid& grid, int begin, int end, float scale) {
  return HWY_DYNAMIC_DISPATCH(LargestAround)(grid, begin, end, scale);
}

float MarkAround(const Grid& grid, int begin, int end, float scale,
                 const Readings& readings, const Levels& levels,
                 const Marks& marks) {
  return HWY_DYNAMIC_DISPATCH(MarkAround)(grid, begin, end, scale, readings,
                                          levels, marks);
}

void MarkSums(const Grid& sums, int begin, int end, const Readings& readings,
              const Levels& levels, const Marks& marks) {
  HWY_DYNAMIC_DISPATCH(MarkSums)(sums, begin, end, readings, levels, marks);
}

}  // namespace tactus::internal::light_touch
#endif  // HWY_ONCE
