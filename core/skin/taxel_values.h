// File: taxel_values.h
//
// Taxel values from the numbers a skin sends: whole frames at once.
//
//   if (!ScaleTaxels<uint16_t>(wire, scale, limit, taxels)) FindTheBadOne();
//
// Compiled for several vector widths by Highway; the widest one that the CPU
// has is used. All give the same bits. Thread-safe: free functions without
// state. Nothing allocates.
#pragma once

#include <cstdint>
#include <span>

namespace tactus {

// One number times `scale`, in double.
template <typename Number>
float ScaledTaxel(Number number, double scale) {
  return static_cast<float>(number * scale);
}

// Writes `taxels.size()` numbers, little-endian and of any alignment, each as
// ScaledTaxel() has it. True if every value lies within 0 and `limit`, which a
// NaN does not. `Number` is uint16_t or float.
template <typename Number>
bool ScaleTaxels(const char* wire, double scale, float limit,
                 std::span<float> taxels);

}  // namespace tactus
