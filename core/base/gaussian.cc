#include "core/base/gaussian.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace tactus {
namespace {

constexpr size_t kPairs = 64;  // a block

// Adding and taking away this rounds to whole numbers.
constexpr double kRounder = 0x1.8p52;

constexpr double Rounded(double x) { return (x + kRounder) - kRounder; }

template <size_t kTerms>
constexpr double Horner(const std::array<double, kTerms>& terms, double x) {
  double sum = terms[kTerms - 1];
  for (size_t n = kTerms - 1; n-- > 0;) sum = sum * x + terms[n];
  return sum;
}

// Of atanh(s) / s, sin(a) / a and cos(a), by powers of the square.
constexpr std::array<double, 11> kAtanh = [] {
  std::array<double, 11> terms;
  for (size_t n = 0; n < terms.size(); ++n) terms[n] = 1.0 / (2 * n + 1);
  return terms;
}();
constexpr std::array<double, 9> kSine = [] {
  std::array<double, 9> terms = {1};
  for (size_t n = 1; n < terms.size(); ++n) {
    terms[n] = -terms[n - 1] / ((2.0 * n) * (2 * n + 1));
  }
  return terms;
}();
constexpr std::array<double, 10> kCosine = [] {
  std::array<double, 10> terms = {1};
  for (size_t n = 1; n < terms.size(); ++n) {
    terms[n] = -terms[n - 1] / ((2.0 * n - 1) * (2 * n));
  }
  return terms;
}();

// Natural logarithm, 0 < x <= 1, without branches.
double Logarithm(double x) {
  // x = mantissa 2^exponent, the mantissa within sqrt(2) of 1.
  constexpr uint64_t kRootHalf = 0x3FE6A09E667F3BCD;
  constexpr uint64_t kOne = 0x3FF0000000000000;
  constexpr uint64_t kMagic = 0x4330000000000000;  // of 2^52
  const uint64_t bits = std::bit_cast<uint64_t>(x);
  const uint64_t biased = (bits + (kOne - kRootHalf)) >> 52;
  const double mantissa = std::bit_cast<double>(bits + kOne - (biased << 52));
  const double exponent =
      std::bit_cast<double>(kMagic | biased) - (0x1p52 + 1023);
  const double s = (mantissa - 1) / (mantissa + 1);
  return exponent * std::numbers::ln2 + 2 * s * Horner(kAtanh, s * s);
}

}  // namespace

void FillGaussian(Random& random, std::span<double> deviates) {
  std::array<double, kPairs> squares;
  std::array<double, kPairs> turns;
  std::array<double, kPairs> first;
  std::array<double, kPairs> second;
  while (!deviates.empty()) {
    const size_t count = std::min(deviates.size(), 2 * kPairs);
    const size_t pairs = (count + 1) / 2;
    for (size_t i = 0; i < pairs; ++i) {
      squares[i] = 1.0 - random.Uniform();
      turns[i] = random.Uniform();
    }
    // Whole blocks, for the processor's vectors.
    for (size_t i = pairs; i < kPairs; ++i) squares[i] = turns[i] = 0.5;
    for (size_t i = 0; i < kPairs; ++i) {
      const double radius = std::sqrt(-2.0 * Logarithm(squares[i]));
      // The angle is so many quarters and at most an eighth of a turn.
      const double quarters = Rounded(4 * turns[i]);
      const double angle = 2 * std::numbers::pi * (turns[i] - 0.25 * quarters);
      const double square = angle * angle;
      const double sine = angle * Horner(kSine, square);
      const double cosine = Horner(kCosine, square);
      // 0 or 1: odd quarters swap the two.
      const double halves = Rounded(0.5 * quarters - 0.25);
      const double odd = quarters - 2 * halves;
      const double even = 1 - odd;
      // Half turns change the sign.
      const double sign = 1 - 2 * (halves - 2 * Rounded(0.5 * halves - 0.25));
      first[i] = sign * radius * (even * cosine - odd * sine);
      second[i] = sign * radius * (even * sine + odd * cosine);
    }
    for (size_t i = 0; i < count / 2; ++i) {
      deviates[2 * i] = first[i];
      deviates[2 * i + 1] = second[i];
    }
    if (count % 2 != 0) deviates[count - 1] = first[pairs - 1];
    deviates = deviates.subspan(count);
  }
}

}  // namespace tactus
