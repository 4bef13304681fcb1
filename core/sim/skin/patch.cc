#include "core/sim/skin/patch.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

// Integral of the dome from its middle to `u`.
double DomeUpTo(double u) { return u - kDome * u * u * u / 3; }

// Adds to `shares` what falls on each of its cells, of width 1 around their
// index, from a patch of half width `half` around `centre`, both in cells.
// `shift` moves the cells, for the images of a wrapped skin.
void AddOverlap(double centre, double half, double reach, double shift,
                std::vector<double>& shares) {
  for (size_t i = 0; i < shares.size(); ++i) {
    const double cell = static_cast<double>(i) + shift - centre;
    const double low = std::max(cell - 0.5, -reach);
    const double high = std::min(cell + 0.5, reach);
    if (high > low) shares[i] += DomeUpTo(high / half) - DomeUpTo(low / half);
  }
}

void Normalise(std::vector<double>& shares) {
  double sum = 0;
  for (double share : shares) sum += share;
  for (double& share : shares) share /= sum;
}

}  // namespace

void SpreadPatch(const SkinLayout& layout, const SkinPoint& centre,
                 double side_m, PatchShares& shares) {
  shares.rows.assign(layout.rows, 0);
  shares.columns.assign(layout.columns, 0);
  const double half_rows = side_m / 2 / layout.row_pitch_m;
  const double half_columns = side_m / 2 / layout.column_pitch_m;
  AddOverlap(centre.row, half_rows, half_rows, 0, shares.rows);
  if (layout.wrap_columns) {
    const double reach = std::min(half_columns, layout.columns / 4.0);
    for (int turn = -1; turn <= 1; ++turn) {
      AddOverlap(centre.column, half_columns, reach,
                 static_cast<double>(turn) * layout.columns, shares.columns);
    }
  } else {
    AddOverlap(centre.column, half_columns, half_columns, 0, shares.columns);
  }
  Normalise(shares.rows);
  Normalise(shares.columns);
}

}  // namespace tactus
