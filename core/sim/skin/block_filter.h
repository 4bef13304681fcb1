// File: block_filter.h
//
// The anti-aliasing filter (butterworth.h) taken 20 samples at a time: from
// 2 kHz to the skin's 100 Hz only every 20th output is wanted, so a block of
// inputs is one product with constant columns. Exactly Butterworth6(200, 2000)
// up to rounding.
//
//   const BlockFilter& filter = BlockFilter::AntiAlias();
//   BlockFilter::Column state = {};
//   state = filter.Step(state, inputs);    // 20 inputs
//   double output = BlockFilter::Output(state);
//
// Immutable; thread-safe.
#pragma once

#include <array>
#include <cstddef>

namespace tactus {

inline constexpr double kSkinRateHz = 100;
inline constexpr double kAntiAliasHz = 200;
// Rate at which a simulated contact enters the filter; a block is one frame.
inline constexpr double kSignalRateHz = 2000;
inline constexpr int kFilterBlock = 20;
// Blocks after which less than 1e-16 is left of what was in the filter: its
// slowest mode fades by 25 in one.
inline constexpr int kForgetful = 12;
// Powers of a ramp that a block takes in closed form.
inline constexpr int kRampPowers = 8;

class BlockFilter {
 public:
  // Six states, then the last output; padded for the processor's vectors.
  using Column = std::array<double, 8>;
  using Inputs = std::array<double, kFilterBlock>;

  static const BlockFilter& AntiAlias();

  static double Output(const Column& state) { return state[6]; }

  // What a block adds to the state: its inputs, or a constant and a ramp
  // (0, 1, 2, ...) in closed form.
  Column Drive(const Inputs& inputs) const;
  const Column& constant() const { return constant_; }
  const Column& ramp() const { return ramp_; }
  // The n-th power of a ramp from -0.95 to 0.95.
  const Column& ramp_power(int n) const { return ramp_powers_[n]; }

  // The state after a block of inputs that have always been such: what was in
  // the filter before is forgotten after kForgetful blocks.
  const Column& steady_constant() const { return steady_constant_; }
  const Column& steady_ramp() const { return steady_ramp_; }
  const Column& steady_power(int n) const { return steady_powers_[n]; }

  // The state after a block that adds `drive`.
  Column Advance(const Column& state, const Column& drive) const;
  Column Step(const Column& state, const Inputs& inputs) const {
    return Advance(state, Drive(inputs));
  }

 private:
  BlockFilter();

  std::array<Column, 6> transition_;
  std::array<Column, kFilterBlock> input_;
  Column constant_ = {};
  Column ramp_ = {};
  std::array<Column, kRampPowers> ramp_powers_ = {};
  Column steady_constant_ = {};
  Column steady_ramp_ = {};
  std::array<Column, kRampPowers> steady_powers_ = {};
};

// to += factor * column.
inline void Add(double factor, const BlockFilter::Column& column,
                BlockFilter::Column& to) {
  for (size_t i = 0; i < to.size(); ++i) to[i] += factor * column[i];
}

}  // namespace tactus
