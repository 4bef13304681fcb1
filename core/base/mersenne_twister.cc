#include "core/base/mersenne_twister.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/base/mersenne_twister.cc"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace tactus::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Moves `state` on by `size` numbers and writes what it gives. Number i of a
// state depends on numbers i, i + 1 and i + size / 2 of those before. Both have
// room for a vector more.
void RefillBlock(size_t size, uint64_t* HWY_RESTRICT state,
                 uint64_t* HWY_RESTRICT numbers) {
  constexpr hn::CappedTag<uint64_t, 8> d;
  const size_t lanes = hn::Lanes(d);
  const auto one = hn::Set(d, 1);
  const auto low = hn::Set(d, 0x7FFFFFFF);
  const auto twist = hn::Set(d, 0xB5026F5AA96619E9);
  const auto next = [&](const uint64_t* here, const uint64_t* ahead) HWY_ATTR {
    const auto after = hn::LoadU(d, here + 1);
    const auto joined =
        hn::Or(hn::AndNot(low, hn::LoadU(d, here)), hn::And(low, after));
    const auto odd = hn::Sub(hn::Zero(d), hn::And(after, one));
    return hn::Xor(hn::Xor(hn::LoadU(d, ahead), hn::ShiftRight<1>(joined)),
                   hn::And(odd, twist));
  };
  // The last vector of the first half may reach into the second half, which
  // overwrites that.
  const size_t half = size / 2;
  for (size_t i = 0; i < half; i += lanes) {
    hn::StoreU(next(state + i, state + i + half), d, numbers + i);
  }
  state[size] = numbers[0];
  for (size_t i = half; i < size; i += lanes) {
    hn::StoreU(next(state + i, numbers + i - half), d, numbers + i);
  }
  const auto mask1 = hn::Set(d, 0x5555555555555555);
  const auto mask2 = hn::Set(d, 0x71D67FFFEDA60000);
  const auto mask3 = hn::Set(d, 0xFFF7EEE000000000);
  for (size_t i = 0; i < size; i += lanes) {
    auto x = hn::LoadU(d, numbers + i);
    hn::StoreU(x, d, state + i);
    x = hn::Xor(x, hn::And(hn::ShiftRight<29>(x), mask1));
    x = hn::Xor(x, hn::And(hn::ShiftLeft<17>(x), mask2));
    x = hn::Xor(x, hn::And(hn::ShiftLeft<37>(x), mask3));
    x = hn::Xor(x, hn::ShiftRight<43>(x));
    hn::StoreU(x, d, numbers + i);
  }
}

}  // namespace tactus::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(RefillBlock);

MersenneTwister::MersenneTwister(uint64_t seed) {
  state_[0] = seed;
  for (size_t i = 1; i < kNumbers; ++i) {
    const uint64_t before = state_[i - 1];
    state_[i] = 6364136223846793005 * (before ^ (before >> 62)) + i;
  }
}

void MersenneTwister::Refill() {
  HWY_DYNAMIC_DISPATCH(RefillBlock)(kNumbers, state_.data(), numbers_.data());
  next_ = 0;
}

void MersenneTwister::Fill(std::span<uint64_t> numbers) {
  while (!numbers.empty()) {
    if (next_ == kNumbers) Refill();
    const size_t count = std::min(numbers.size(), kNumbers - next_);
    std::copy_n(numbers_.begin() + next_, count, numbers.begin());
    next_ += count;
    numbers = numbers.subspan(count);
  }
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
