// File: touched.h
//
// Finds the taxels of a frame that reach a threshold, one bit per taxel, and
// the largest value and the sum of such taxels. Works on the whole frame at
// once.
//
//   std::vector<uint64_t> bits(TouchedWords(taxels.size()));
//   if (FindTouched(taxels, threshold, bits)) {
//     const TouchedSum sum = SumTouched(taxels, bits);
//   }
//
// Compiled for several vector widths by Highway; the widest one that the CPU
// has is used. All give the same bits. Thread-safe: free functions without
// state. Nothing allocates.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::internal {

inline constexpr size_t TouchedWords(size_t taxels) {
  return (taxels + 63) / 64;
}

// Sets bit i % 64 of bits[i / 64] if taxels[i] >= threshold, which a NaN is
// not, and clears the others. `bits` has TouchedWords() words. True if any bit
// is set.
bool FindTouched(std::span<const float> taxels, float threshold,
                 std::span<uint64_t> bits);

struct TouchedSum {
  float max_value = 0;
  double total = 0;
};

// Returns maximum and sum over the taxels whose bits are set. Their values must
// be above 0.
TouchedSum SumTouched(std::span<const float> taxels,
                      std::span<const uint64_t> bits);

// The same, bit for bit, of stretches of taxels in rising order: quicker for a
// small region of a large frame.
class TouchedAdder {
 public:
  // Adds taxels begin .. end-1 of the frame.
  void Add(std::span<const float> taxels, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      max_value_ = std::max(max_value_, taxels[i]);
      stripes_[i % kStripes] += taxels[i];
    }
  }
  TouchedSum Sum() const { return {max_value_, SumOfStripes(stripes_)}; }

  // Sums run in this many stripes at any vector width, so that every width
  // rounds alike.
  static constexpr size_t kStripes = 16;
  static double SumOfStripes(std::array<double, kStripes> stripes) {
    for (size_t half = kStripes / 2; half > 0; half /= 2) {
      for (size_t i = 0; i < half; ++i) stripes[i] += stripes[i + half];
    }
    return stripes[0];
  }

 private:
  float max_value_ = 0;
  std::array<double, kStripes> stripes_ = {};
};

}  // namespace tactus::internal
