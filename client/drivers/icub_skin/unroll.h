// File: unroll.h
//
// Unroll: lays the taxels of a curved patch, such as one around a forearm,
// flat.
//
//   const std::vector<Eigen::Vector3d> flat = icub::Unroll(points, normals);
//
// If the normals show a curved patch, its axis is the direction that the
// normals have the least of, and a circle is fitted to the points across it. A
// point's place is then the arc along this circle (x) and the way along the
// axis (y); the cut is in the widest gap between points. A flat patch, or one
// whose points have no normals, is returned as it is. A free function without
// state; thread-safe.
#pragma once

#include <vector>

#include "Eigen/Core"

namespace tactus::internal::client::icub {

// One normal for each point, of unit length or zero. Metres.
std::vector<Eigen::Vector3d> Unroll(
    const std::vector<Eigen::Vector3d>& points,
    const std::vector<Eigen::Vector3d>& normals);

}  // namespace tactus::internal::client::icub
