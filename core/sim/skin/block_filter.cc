#include "core/sim/skin/block_filter.h"

#include <algorithm>

#include "core/sim/skin/butterworth.h"

namespace tactus::internal {
namespace {

static_assert(kSignalRateHz == kFilterBlock * kSkinRateHz);

// The column after `steps` samples of input 0.
BlockFilter::Column Rest(Butterworth6 filter, int steps) {
  BlockFilter::Column column = {};
  for (int i = 0; i < steps; ++i) column[6] = filter.Step(0);
  const std::array<double, 6> state = filter.state();
  std::copy(state.begin(), state.end(), column.begin());
  return column;
}

}  // namespace

const BlockFilter& BlockFilter::AntiAlias() {
  static const BlockFilter filter;
  return filter;
}

BlockFilter::BlockFilter() {
  Butterworth6 filter(kAntiAliasHz, kSignalRateHz);
  for (int i = 0; i < 6; ++i) {
    std::array<double, 6> unit = {};
    unit[i] = 1;
    filter.set_state(unit);
    transition_[i] = Rest(filter, kFilterBlock);
  }
  for (int j = 0; j < kFilterBlock; ++j) {
    filter.set_state({});
    const double output = filter.Step(1);
    input_[j] = Rest(filter, kFilterBlock - 1 - j);
    if (j == kFilterBlock - 1) input_[j][6] = output;
    Add(1, input_[j], constant_);
    Add(j, input_[j], ramp_);
    const double place =
        (2 * j - (kFilterBlock - 1)) / static_cast<double>(kFilterBlock);
    double power = 1;
    for (Column& column : ramp_powers_) {
      Add(power, input_[j], column);
      power *= place;
    }
  }
  // From so long ago that powers of a ramp are forgotten too.
  for (int block = -2 * kSettlingBlocks; block <= 0; ++block) {
    Inputs ramp;
    for (int j = 0; j < kFilterBlock; ++j) ramp[j] = block * kFilterBlock + j;
    steady_constant_ = Advance(steady_constant_, constant_);
    steady_ramp_ = Step(steady_ramp_, ramp);
    Inputs power;
    power.fill(1);
    for (Column& column : steady_powers_) {
      column = Step(column, power);
      for (int j = 0; j < kFilterBlock; ++j) {
        power[j] *= (2 * ramp[j] - (kFilterBlock - 1)) / kFilterBlock;
      }
    }
  }
}

BlockFilter::Column BlockFilter::Drive(const Inputs& inputs) const {
  Column drive = {};
  for (int j = 0; j < kFilterBlock; ++j) Add(inputs[j], input_[j], drive);
  return drive;
}

BlockFilter::Column BlockFilter::Advance(const Column& state,
                                         const Column& drive) const {
  Column next = drive;
  for (int i = 0; i < 6; ++i) Add(state[i], transition_[i], next);
  return next;
}

}  // namespace tactus::internal
