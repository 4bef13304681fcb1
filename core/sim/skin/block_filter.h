// File: block_filter.h
//
// The anti-aliasing filter (butterworth.h) in blocks of 20 samples. From 2 kHz
// to the skin's 100 Hz only every 20th output is needed, so a block of inputs
// is one product with constant columns. Equals Butterworth6(200, 2000) up to
// rounding.
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

namespace tactus::internal {

inline constexpr double kSkinRateHz = 100;
inline constexpr double kAntiAliasHz = 200;
// Rate of a simulated contact at the filter's input. One block is one frame.
inline constexpr double kSignalRateHz = 2000;
inline constexpr int kFilterBlock = 20;
// Number of blocks after which less than 1e-16 of the filter's earlier state is
// left: its slowest mode decays by a factor of 25 per block.
inline constexpr int kSettlingBlocks = 12;
// Number of powers of a ramp that have a closed form.
inline constexpr int kRampPowers = 8;

class BlockFilter {
 public:
  // Six states, then the last output; padded to a whole vector register.
  using Column = std::array<double, 8>;
  using Inputs = std::array<double, kFilterBlock>;

  static const BlockFilter& AntiAlias();

  static double Output(const Column& state) { return state[6]; }

  // The contribution of a block to the state: of its inputs, or in closed form
  // of a constant and of a ramp (0, 1, 2, ...).
  Column Drive(const Inputs& inputs) const;
  const Column& constant() const { return constant_; }
  const Column& ramp() const { return ramp_; }
  // The n-th power of a ramp from -0.95 to 0.95.
  const Column& ramp_power(int n) const { return ramp_powers_[n]; }

  // The state after a block if all earlier inputs had the same form. Correct
  // after kSettlingBlocks blocks of that form.
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

}  // namespace tactus::internal
