// File: taxel_values.h
//
// Makes taxel values from the numbers that a skin sends, a whole frame at once.
//
//   const TaxelRange range = {0, limit};
//   if (!TaxelsWithin(type, wire, taxels.size(), scale, range)) return;
//   ScaleTaxels(type, wire, scale, taxels);
//
// Compiled for several vector widths by Highway; the widest one that the CPU
// has is used. All give the same bits. Thread-safe: free functions without
// state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactus/v1/common.pb.h"

namespace tactus::internal {

// Returns one number times `scale`, computed in double.
template <typename Number>
float ScaledTaxel(Number number, double scale) {
  return static_cast<float>(number * scale);
}

// Bytes of a number; 0 for a type that there is not.
size_t TaxelBytes(v1::TaxelType type);

// The values that a taxel may have.
struct TaxelRange {
  float lowest = 0;
  float largest = 0;

  // False for a NaN.
  bool Has(float value) const { return value >= lowest && value <= largest; }
};

// In all, `wire` holds little-endian numbers of any alignment, and `type` is
// one that there is.

// The first of the numbers at `wire` times `scale`.
float ScaledTaxel(v1::TaxelType type, const char* wire, double scale);

// Writes ScaledTaxel() of `taxels.size()` numbers to `taxels`.
void ScaleTaxels(v1::TaxelType type, const char* wire, double scale,
                 std::span<float> taxels);

// True if ScaledTaxel() of each of `count` numbers is in `range`.
bool TaxelsWithin(v1::TaxelType type, const char* wire, size_t count,
                  double scale, const TaxelRange& range);

}  // namespace tactus::internal
