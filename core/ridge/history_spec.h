// File: history_spec.h
//
// HistorySpec: how the frames of a contact become the numbers of a
// TouchHistory (touch_history.h).
//
// A frame is seen in three views: the loads of the taxels; their roots; and
// their shape, each root divided by the root of the whole load. A channel is a
// number of one view of one frame: one for each cell of the skin, and one of
// the whole skin, which is the whole load, its root, and its logarithm. A cell
// is a taxel, or on a large skin a block of neighbours.
//
// Plain data. Copyable.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/ridge/mini_kernels.h"

namespace tactus::internal {

inline constexpr int kHistoryViews = 3;
// Numbers of a channel: mean, deviation, largest, smallest, mean step, the
// fraction of frames in which it is not 0, and two running means.
inline constexpr int kHistoryStatistics = 8;
// Means of a channel over stretches of the contact so far, all of one length.
inline constexpr int kHistoryStretches = 10;
// More cells than this are put together.
inline constexpr int kMaxHistoryCells = 520;
// Channels that a mixture takes at most.
inline constexpr int kMiniMixed = 8;

struct HistorySpec {
  // The skin's.
  int rows = 0;
  int columns = 0;
  // Neighbours that make a cell, along a row and along a column.
  int block = 1;
  // Factors that bring the channels of a view to about 1.
  std::array<float, kHistoryViews> scale = {1, 1, 1};
  // The series that each kernel reads: a sum over channels, [views][kernels]
  // [kMiniMixed]. A weight of 0 ends it.
  std::vector<uint16_t> mixed_channel;
  std::vector<float> mixed_weight;
  // [views][dilations][thresholds][kernels]
  std::vector<float> threshold;

  int CellRows() const { return (rows + block - 1) / block; }
  int CellColumns() const { return (columns + block - 1) / block; }
  int cells() const { return CellRows() * CellColumns(); }
  // Channels of a view.
  int channels() const { return cells() + 1; }
  // Numbers that a contact becomes.
  size_t numbers() const {
    return size_t{kHistoryViews} *
           (static_cast<size_t>(channels()) *
                (kHistoryStatistics + kHistoryStretches) +
            size_t{kMiniDilationCount} * kMiniThresholds * kMiniKernels);
  }
  uint16_t CellOf(uint32_t taxel) const {
    const auto row = static_cast<int>(taxel) / columns;
    const auto column = static_cast<int>(taxel) % columns;
    return static_cast<uint16_t>((row / block) * CellColumns() +
                                 column / block);
  }
};

// The smallest blocks that leave at most kMaxHistoryCells cells.
int HistoryBlock(int rows, int columns);

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const HistorySpec& spec);

}  // namespace tactus::internal
