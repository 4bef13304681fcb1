// File: touched.h
//
// Compares all taxels of a frame with a threshold at once: one bit a taxel.
//
//   std::vector<uint64_t> bits(TouchedWords(taxels.size()));
//   if (FindTouched(taxels, threshold, bits)) { ... }
//
// Compiled for several vector widths by Highway; the widest one that the CPU
// has is used. All give the same bits. Thread-safe: a free function without
// state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus {

inline constexpr size_t TouchedWords(size_t taxels) {
  return (taxels + 63) / 64;
}

// Sets bit i % 64 of bits[i / 64] if taxels[i] >= threshold, which a NaN is
// not, and clears the others. `bits` has TouchedWords() words. True if any bit
// is set.
bool FindTouched(std::span<const float> taxels, float threshold,
                 std::span<uint64_t> bits);

}  // namespace tactus
