#include "core/skin/geometry.h"

#include <cmath>
#include <numbers>

namespace tactus::internal {
namespace {

double ColumnAngle(const SkinLayout& layout, double column) {
  return 2 * std::numbers::pi * column / layout.columns;
}

}  // namespace

Eigen::Vector3d LinkPosition(const SkinLayout& layout, const SkinPoint& point) {
  const double along = point.row * layout.row_pitch_m;
  if (!layout.wrap_columns) {
    return {point.column * layout.column_pitch_m, along, 0};
  }
  const double angle = ColumnAngle(layout, point.column);
  const double radius = layout.CylinderRadius();
  return {radius * std::cos(angle), radius * std::sin(angle), along};
}

Eigen::Vector3d LinkNormal(const SkinLayout& layout, const SkinPoint& point) {
  if (!layout.wrap_columns) return {0, 0, 1};
  const double angle = ColumnAngle(layout, point.column);
  return {std::cos(angle), std::sin(angle), 0};
}

double SkinDistance(const SkinLayout& layout, const SkinPoint& a,
                    const SkinPoint& b) {
  double columns = std::abs(a.column - b.column);
  if (layout.wrap_columns) {
    // Seldom needed, and slow.
    if (columns >= layout.columns) columns = std::fmod(columns, layout.columns);
    columns = std::min(columns, layout.columns - columns);
  }
  return std::hypot(columns * layout.column_pitch_m,
                    (a.row - b.row) * layout.row_pitch_m);
}

}  // namespace tactus::internal
