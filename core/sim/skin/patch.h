// File: patch.h
//
// Spreads the force of a square contact patch over taxels. The pressure is a
// flat parabolic dome over the patch. Each taxel gets the pressure on its cell
// (one pitch by one pitch); a partly covered taxel gets that of its covered
// part.
//
//   PatchShares shares;
//   SpreadPatch(layout, {7.5, 3}, /*side_m=*/0.02, shares);
//   float newton = force * shares.Of(row, column);
//
// The patch is clipped to the skin: rows at its ends and columns at its sides.
// On a wrapped skin, columns are clipped at half the circumference, because a
// flat face cannot touch the far side. The rest carries the whole force. Not
// thread-safe: one PatchShares per thread; reused without allocating.
#pragma once

#include <vector>

#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

// The dome is a product of 1 - kDome u^2 along rows and columns, u from -1 to
// 1 across the patch: half the pressure in the middle of an edge.
inline constexpr double kDome = 0.5;

struct PatchShares {
  // Fractions of the force by row and by column; each sums to 1.
  std::vector<double> rows;
  std::vector<double> columns;

  double Of(int row, int column) const { return rows[row] * columns[column]; }
};

// Spreads a patch of `side_m` > 0 centred at `centre`, which is on the skin.
void SpreadPatch(const SkinLayout& layout, const SkinPoint& centre,
                 double side_m, PatchShares& shares);

}  // namespace tactus
