#include "core/sim/skin/taxel_kernels.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sim/skin/taxel_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::taxel_kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Runs step(d, i) for whole vectors, then one by one.
template <class Step>
HWY_INLINE void ForEach(size_t count, const Step& step) {
  constexpr hn::CappedTag<double, 8> d;
  constexpr size_t kLanes = hn::MaxLanes(d);
  size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) step(d, i);
  for (; i < count; ++i) step(hn::CappedTag<double, 1>(), i);
}

void Read(const double* HWY_RESTRICT forces, size_t count,
          const Electronics& electronics, const TaxelState& state,
          double* HWY_RESTRICT readings) {
  const Electronics by = electronics;
  const double* HWY_RESTRICT const alive = state.alive;
  const double* HWY_RESTRICT const offset = state.offset;
  const double* HWY_RESTRICT const deviates = state.deviates;
  double* HWY_RESTRICT const lagging = state.lagging;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    const auto force = hn::LoadU(d, forces + i);
    auto late = hn::LoadU(d, lagging + i);
    late = hn::Add(late, hn::Mul(hn::Set(d, by.follow), hn::Sub(force, late)));
    hn::StoreU(late, d, lagging + i);
    auto reading = hn::Mul(hn::Set(d, 1 - by.lagging), force);
    reading = hn::Add(reading, hn::Mul(hn::Set(d, by.lagging), late));
    reading = hn::Add(reading, hn::LoadU(d, offset + i));
    reading = hn::Add(
        reading, hn::Mul(hn::Set(d, by.noise_n), hn::LoadU(d, deviates + i)));
    hn::StoreU(hn::Mul(hn::LoadU(d, alive + i), hn::Max(reading, hn::Zero(d))),
               d, readings + i);
  });
}

void Quantise(const double* HWY_RESTRICT readings, size_t count, double step,
              uint16_t* HWY_RESTRICT steps) {
  // The largest double below a half: the sum with it rounds to the next whole
  // number from a half on and not before, and then its fraction is cut off.
  constexpr double kAlmostHalf = 0x1.fffffffffffffp-2;
  ForEach(count, [&](auto d, size_t i) HWY_ATTR {
    constexpr hn::Rebind<int32_t, decltype(d)> whole;
    constexpr hn::Rebind<uint16_t, decltype(d)> result;
    const auto number =
        hn::Min(hn::Div(hn::LoadU(d, readings + i), hn::Set(d, step)),
                hn::Set(d, 65'535));
    const auto rounded =
        hn::DemoteTo(whole, hn::Add(number, hn::Set(d, kAlmostHalf)));
    hn::StoreU(hn::DemoteTo(result, rounded), result, steps + i);
  });
}

}  // namespace tactus::internal::taxel_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal::taxel_kernels {

HWY_EXPORT(Read);
HWY_EXPORT(Quantise);

void Read(std::span<const double> forces, const Electronics& electronics,
          const TaxelState& state, double* readings) {
  HWY_DYNAMIC_DISPATCH(Read)
  (forces.data(), forces.size(), electronics, state, readings);
}

void Quantise(std::span<const double> readings, double step, uint16_t* steps) {
  HWY_DYNAMIC_DISPATCH(Quantise)
  (readings.data(), readings.size(), step, steps);
}

}  // namespace tactus::internal::taxel_kernels
#endif  // HWY_ONCE
