// File: taxel_grid.h
//
// Puts taxels of known positions on a regular grid, which is what the pipeline
// works on. Cells without a taxel are masked.
//
//   TACTUS_ASSIGN_OR_RETURN(const TaxelGrid grid, PlaceOnGrid(positions));
//   frame[grid.cells[i]] = value_of_taxel_i;
//
// The pitches are chosen so that no two taxels share a cell and that as many
// pairs of neighbours as possible stay neighbours: a triangular skin keeps all
// six. Plain data and a free function without state; thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"

namespace tactus::internal {

struct TaxelGrid {
  int rows = 0;
  int columns = 0;
  double row_pitch_m = 0;
  double column_pitch_m = 0;
  // For each taxel its cell, row-major.
  std::vector<int> cells;
  // One byte per cell, 0 = no taxel; empty if every cell has one.
  std::vector<uint8_t> mask;
  // Pairs of taxels closer than 1.3 times the usual distance of neighbours, and
  // how many of them are not among each other's 8 neighbours on the grid.
  int neighbours = 0;
  int separated = 0;
};

// `positions` [taxels] in metres. They are projected on the plane that fits
// them best: columns run along x and rows along y if they lie in the x-y plane,
// else along the first and the second principal axis. INVALID_CONFIG if there
// are fewer than two taxels or more than limits::kMaxTaxels, if two have one
// place, or if they fit on no grid of limits::kMaxRows x kMaxColumns.
absl::StatusOr<TaxelGrid> PlaceOnGrid(
    const std::vector<Eigen::Vector3d>& positions);

}  // namespace tactus::internal
