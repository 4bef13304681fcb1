// File: taxel_values.h
//
// Makes taxel values from the numbers that a skin sends, a whole frame at once.
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

// Returns one number times `scale`, computed in double.
template <typename Number>
float ScaledTaxel(Number number, double scale) {
  return static_cast<float>(number * scale);
}

// Writes ScaledTaxel() of `taxels.size()` numbers to `taxels`. `wire` holds
// little-endian numbers of any alignment. Returns true if every value lies
// within 0 and `limit`; a NaN does not. `Number` is uint16_t or float.
template <typename Number>
bool ScaleTaxels(const char* wire, double scale, float limit,
                 std::span<float> taxels);

}  // namespace tactus
