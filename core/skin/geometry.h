// File: geometry.h
//
// Positions of taxels on the link that carries the skin.
//
//   const Eigen::Vector3d position = LinkPosition(layout, {.row = 3.5});
//
// `layout` must be valid. Thread-safe: free functions without state.
#pragma once

#include "Eigen/Core"
#include "core/skin/layout.h"

namespace tactus::internal {

// A place on the skin by fractional row and column.
struct SkinPoint {
  double row = 0;
  double column = 0;
};

// Position of `point` in the link frame, metres. A flat skin lies in the x-y
// plane (x along columns, y along rows); a wrapped one is a cylinder around z
// with column 0 on the +x axis and rows along z.
Eigen::Vector3d LinkPosition(const SkinLayout& layout, const SkinPoint& point);

// Outward unit normal of the skin at `point` in the link frame.
Eigen::Vector3d LinkNormal(const SkinLayout& layout, const SkinPoint& point);

// Distance along the skin between two points in metres; the shorter way if
// columns wrap.
double SkinDistance(const SkinLayout& layout, const SkinPoint& a,
                    const SkinPoint& b);

}  // namespace tactus::internal
