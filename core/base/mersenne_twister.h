// File: mersenne_twister.h
//
// The 64-bit Mersenne Twister, std::mt19937_64, with vector instructions. It
// gives the same numbers several times as fast.
//
//   MersenneTwister engine(seed);
//   const uint64_t one = engine();
//   std::array<uint64_t, 100> many;
//   engine.Fill(many);
//
// Compiled for several vector widths by Highway; all give the same bits. Owns
// its state; copyable. Not thread-safe: one per thread. Source: Matsumoto and
// Nishimura, "Mersenne twister" (1998), and Nishimura, "Tables of 64-bit
// Mersenne twisters" (2000).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::internal {

class MersenneTwister {
 public:
  explicit MersenneTwister(uint64_t seed);

  uint64_t operator()() {
    if (next_ == kNumbers) Refill();
    return numbers_[next_++];
  }

  // Fills `numbers` with the next ones.
  void Fill(std::span<uint64_t> numbers);

 private:
  // Draws the next kNumbers numbers.
  void Refill();

  static constexpr size_t kNumbers = 312;
  // With room for the rest of the last vector.
  using Block = std::array<uint64_t, 320>;

  Block state_ = {};
  Block numbers_ = {};
  size_t next_ = kNumbers;
};

}  // namespace tactus::internal
