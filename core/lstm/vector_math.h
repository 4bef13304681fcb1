// File: vector_math.h
//
// Functions on vectors of any width, for kernels.cc: loads, stores, and the
// activations of LSTM cells with their slopes. They use only additions,
// products, divisions and selections, lane by lane, so every width and every
// CPU gives the same bits.
//
//   Lanes<8>::Floats x;
//   Load(from, x);
//   Activate(Activation::kTanh, x);
//
// All functions are always inlined and take vectors by reference, because the
// ABI of vectors differs between CPUs. Thread-safe.
#pragma once

#include <cstdint>

#include "core/lstm/network.h"

#define TACTUS_INLINE [[gnu::always_inline]] inline
#define TACTUS_INLINE_LAMBDA __attribute__((always_inline))

namespace tactus::internal {

template <int kLanes>
struct Lanes {
  using Floats [[gnu::vector_size(kLanes * sizeof(float))]] = float;
  using Ints [[gnu::vector_size(kLanes * sizeof(int32_t))]] = int32_t;
};

template <typename Floats>
TACTUS_INLINE void Load(const float* from, Floats& to) {
  __builtin_memcpy(&to, from, sizeof(Floats));
}

template <typename Floats>
TACTUS_INLINE void Store(const Floats& from, float* to) {
  __builtin_memcpy(to, &from, sizeof(Floats));
}

// Stores the first `count` lanes, or all if there are fewer.
template <typename Floats>
TACTUS_INLINE void StoreFirst(const Floats& from, int count, float* to) {
  constexpr int kLanes = sizeof(Floats) / sizeof(float);
  if (count >= kLanes) {
    Store(from, to);
  } else {
    for (int i = 0; i < count; ++i) to[i] = from[i];
  }
}

template <typename Floats>
TACTUS_INLINE void Clamp(float low, float high, Floats& x) {
  const Floats lows = low - Floats{};
  const Floats highs = high - Floats{};
  x = x < lows ? lows : x;
  x = x > highs ? highs : x;
}

template <typename Floats>
TACTUS_INLINE void Absolute(Floats& x) {
  x = x < Floats{} ? -x : x;
}

// exp(x), |x| <= 87, within 2 ulp: exp(r) 2^n with n = round(x / ln 2), and
// the polynomial of the Cephes library for exp(r).
template <typename Floats>
TACTUS_INLINE void Exp(Floats& x) {
  using Ints = typename Lanes<sizeof(Floats) / sizeof(float)>::Ints;
  // Adding 1.5 * 2^23 leaves round(x) in the lowest bits.
  constexpr float kRound = 12582912.0F;
  const Floats shifted = x * 1.44269504088896341F + kRound;
  const Floats n = shifted - kRound;
  const Floats r = x - n * 0.693359375F - n * -2.12194440e-4F;
  Floats sum = r * 1.9875691500e-4F + 1.3981999507e-3F;
  sum = sum * r + 8.3334519073e-3F;
  sum = sum * r + 4.1665795894e-2F;
  sum = sum * r + 1.6666665459e-1F;
  sum = sum * r + 5.0000001201e-1F;
  sum = sum * (r * r) + r + 1.0F;
  const Ints power = (reinterpret_cast<Ints>(shifted) << 23) + (127 << 23);
  x = sum * reinterpret_cast<Floats>(power);
}

template <typename Floats>
TACTUS_INLINE void Activate(Activation activation, Floats& x) {
  Floats size = x;
  Absolute(size);
  if (activation == Activation::kSoftsign) {
    x = x / (size + 1.0F);
    return;
  }
  // tanh |x| = (1 - e) / (1 + e), e = exp(-2 |x|); 1 from 9.1 on.
  Floats e = size * -2.0F;
  Clamp(-40.0F, 0.0F, e);
  Exp(e);
  const Floats result = (1.0F - e) / (1.0F + e);
  x = x < Floats{} ? -result : result;
}

template <typename Floats>
TACTUS_INLINE void ActivateGate(GateActivation activation, Floats& x) {
  if (activation == GateActivation::kHardSigmoid) {
    x = x * 0.2F + 0.5F;
    Clamp(0.0F, 1.0F, x);
    return;
  }
  Floats e = -x;
  Clamp(-87.0F, 87.0F, e);
  Exp(e);
  x = 1.0F / (1.0F + e);
}

// `slope` times the derivative of the activation whose value is y.
template <typename Floats>
TACTUS_INLINE void TimesSlope(Activation activation, const Floats& y,
                              Floats& slope) {
  if (activation == Activation::kTanh) {
    slope *= 1.0F - y * y;
    return;
  }
  Floats rest = y;
  Absolute(rest);
  rest = 1.0F - rest;
  slope *= rest * rest;
}

template <typename Floats>
TACTUS_INLINE void TimesGateSlope(GateActivation activation, const Floats& y,
                                  Floats& slope) {
  const Floats room = y * (1.0F - y);
  if (activation == GateActivation::kSigmoid) {
    slope *= room;
  } else {
    slope = room > Floats{} ? slope * 0.2F : Floats{};
  }
}

template <typename Floats>
TACTUS_INLINE void FlushTiny(Floats& x) {
  Floats size = x;
  Absolute(size);
  x = size < 1e-30F - Floats{} ? Floats{} : x;
}

}  // namespace tactus::internal
