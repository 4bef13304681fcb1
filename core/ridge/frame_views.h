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
// Components (core/taxels/components.h) are further cells, plane by plane, of
// the same blocks; they do not count as load. Auxiliary ones have a cell each,
// behind the planes, and no shape: that view has their roots.
//
//   ReadViews(views, sample.loads, channels);  // kFrameViews * channels()
//
// Plain data. Copyable. Thread-safe: free functions without state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/taxels/components.h"
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
  // Planes of components.
  int planes = 0;
  // For each auxiliary component the factor that brings it to about 1.
  std::vector<float> auxiliary_scale = {};

  int CellRows() const { return (rows + block - 1) / block; }
  int CellColumns() const { return (columns + block - 1) / block; }
  // Cells of the skin and of the planes.
  int PlaneCells() const { return CellRows() * CellColumns() * (1 + planes); }
  int auxiliary() const { return static_cast<int>(auxiliary_scale.size()); }
  int cells() const { return PlaneCells() + auxiliary(); }
  // Channels of a view.
  int channels() const { return cells() + 1; }
  TaxelShape shape() const { return {rows, columns, planes, auxiliary()}; }
  // The cell of a taxel or component below shape().total().
  uint16_t CellOf(uint32_t taxel) const {
    const int taxels = rows * columns;
    const int plane = static_cast<int>(taxel) / taxels;
    const int place = static_cast<int>(taxel) % taxels;
    if (plane > planes) {
      return static_cast<uint16_t>(PlaneCells() + static_cast<int>(taxel) -
                                   taxels * (1 + planes));
    }
    const int row = place / columns;
    const int column = place % columns;
    return static_cast<uint16_t>(plane * CellRows() * CellColumns() +
                                 (row / block) * CellColumns() +
                                 column / block);
  }
};

// The smallest blocks that leave at most kMaxHistoryCells cells.
int HistoryBlock(const TaxelShape& shape);

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const FrameViews& views);

// Writes the channels of all views of a frame, view by view. Takes its touched
// taxels and components; those beyond shape().total() are left out. Allocates
// nothing.
void ReadViews(const FrameViews& views, std::span<const TaxelLoad> loads,
               std::span<float> channels);

}  // namespace tactus::internal
