// File: taxel_values.h
//
// Makes taxel values from the numbers that a skin sends, a whole frame at once.
//
//   if (!TaxelsWithin<uint16_t>(wire, taxels.size(), scale, limit)) return;
//   ScaleTaxels<uint16_t>(wire, scale, taxels);
//
// Compiled for several vector widths by Highway; the widest one that the CPU
// has is used. All give the same bits. Thread-safe: free functions without
// state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus {

// Returns one number times `scale`, computed in double.
template <typename Number>
float ScaledTaxel(Number number, double scale) {
  return static_cast<float>(number * scale);
}

// In both, `wire` holds little-endian numbers of any alignment, and `Number` is
// uint16_t or float.

// Writes ScaledTaxel() of `taxels.size()` numbers to `taxels`.
template <typename Number>
void ScaleTaxels(const char* wire, double scale, std::span<float> taxels);

// True if ScaledTaxel() of each of `count` numbers lies within 0 and `limit`; a
// NaN does not.
template <typename Number>
bool TaxelsWithin(const char* wire, size_t count, double scale, float limit);

}  // namespace tactus
