#include "core/sim/skin/dent_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sim/skin/dent_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::dent_kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
HWY_INLINE V Cube(V x) {
  return hn::Mul(hn::Mul(x, x), x);
}

void Cut(const Dent& dent, const double* HWY_RESTRICT places, size_t count,
         const double* HWY_RESTRICT widths, double* HWY_RESTRICT volumes,
         double* HWY_RESTRICT areas) {
  constexpr hn::CappedTag<double, kStrips> d;
  const auto zero = hn::Zero(d);
  const auto rise = hn::Set(d, dent.rise);
  const auto middle = hn::Set(d, dent.depth);
  const auto curvature = hn::Set(d, dent.curvature);
  const auto three = hn::Set(d, 3);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto depth = hn::Add(middle, hn::Mul(hn::LoadU(d, places + i), rise));
    // Infinite without curvature; not a number where there is no dent.
    const auto half = hn::Sqrt(hn::Div(depth, curvature));
    const auto low = hn::Max(hn::Set(d, dent.low), hn::Neg(half));
    const auto high = hn::Min(hn::Set(d, dent.high), half);
    const auto length = hn::Sub(high, low);
    const auto section = hn::Sub(
        hn::Mul(depth, length),
        hn::Div(hn::Mul(curvature, hn::Sub(Cube(high), Cube(low))), three));
    const auto dented = hn::And(hn::Gt(depth, zero), hn::Gt(high, low));
    const auto width = hn::LoadU(d, widths + i);
    hn::StoreU(hn::IfThenElseZero(dented, hn::Mul(width, section)), d,
               volumes + i);
    hn::StoreU(hn::IfThenElseZero(dented, hn::Mul(width, length)), d,
               areas + i);
  }
}

}  // namespace tactus::internal::dent_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal::dent_kernels {

HWY_EXPORT(Cut);

void Cut(const Dent& dent, std::span<const double> places, const double* widths,
         double* volumes, double* areas) {
  HWY_DYNAMIC_DISPATCH(Cut)
  (dent, places.data(), places.size(), widths, volumes, areas);
}

}  // namespace tactus::internal::dent_kernels
#endif  // HWY_ONCE
