// File: patch.h
//
// How the force of a square contact patch spreads over taxels: a gentle
// parabolic dome of pressure over the patch, each taxel taking what falls on
// its cell (one pitch by one pitch; a partly covered taxel its covered part).
//
//   PatchShares shares;
//   SpreadPatch(layout, {7.5, 3}, /*side_m=*/0.02, shares);
//   float newton = force * shares.Of(row, column);
//
// The patch is clipped to the skin: rows at its ends, columns at its sides,
// or on a wrapped skin at half the circumference, as a flat face cannot touch
// the far side. What is left carries the whole force.
// Not thread-safe: one PatchShares per thread; reused without allocating.
#pragma once

#include <vector>

#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

// The dome is a product of 1 - kDome u^2 along rows and columns, u from -1 to
// 1 across the patch: half the pressure in the middle of an edge.
inline constexpr double kDome = 0.5;

struct PatchShares {
  // Shares by row and by column; each sums to 1.
  std::vector<double> rows;
  std::vector<double> columns;

  double Of(int row, int column) const { return rows[row] * columns[column]; }
};

// Spreads a patch of `side_m` > 0 centred at `centre`, which is on the skin.
void SpreadPatch(const SkinLayout& layout, const SkinPoint& centre,
                 double side_m, PatchShares& shares);

}  // namespace tactus
