// File: frame_views.h
//
// FrameViews: how a frame of a skin becomes channels, for learners that see all
// taxels (touch_history.h, core/nearest).
//
// A frame is seen in three views: the loads of the taxels; their roots; and
// their shape, each root divided by the root of the whole load. A channel is a
// number of one view of one frame: one for each cell of the skin, and one of
// the whole skin, which is the whole load, its root, and its logarithm. A cell
// is a taxel, or on a large skin a block of neighbours.
//
//   ReadViews(views, sample.loads, channels);  // kFrameViews * channels()
//
// Plain data. Copyable. Thread-safe: free functions without state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

inline constexpr int kFrameViews = 3;
// More cells than this are put together.
inline constexpr int kMaxHistoryCells = 520;

struct FrameViews {
  // The skin's.
  int rows = 0;
  int columns = 0;
  // Neighbours that make a cell, along a row and along a column.
  int block = 1;
  // Factors that bring the channels of a view to about 1.
  std::array<float, kFrameViews> scale = {1, 1, 1};

  int CellRows() const { return (rows + block - 1) / block; }
  int CellColumns() const { return (columns + block - 1) / block; }
  int cells() const { return CellRows() * CellColumns(); }
  // Channels of a view.
  int channels() const { return cells() + 1; }
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
absl::Status Validate(const FrameViews& views);

// Writes the channels of all views of a frame, view by view. Takes its touched
// taxels; others than those of the skin must not occur. Allocates nothing.
void ReadViews(const FrameViews& views, std::span<const TaxelLoad> loads,
               std::span<float> channels);

}  // namespace tactus::internal
