// File: gain_curve.h
//
// GainCurve: what load a taxel's reading stands for, piecewise linear.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const GainCurve curve,
//       GainCurve::Make({{.reading = 40, .load = 0.5},
//                        {.reading = 120, .load = 2}}));
//   const double newton = curve.Load(80);
//
// The curve begins at (0, 0), runs through the points, and goes on beyond the
// last one with the last slope. Negative readings have negative loads, with the
// first slope. Immutable; thread-safe.
#pragma once

#include <utility>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::internal::client {

struct GainPoint {
  // Above the taxel's baseline, in the numbers that the skin sends.
  double reading = 0;
  // In the layout's unit.
  double load = 0;

  bool operator==(const GainPoint&) const = default;
};

class GainCurve {
 public:
  // INVALID_CONFIG unless there is a point, all numbers are finite, and
  // readings and loads rise from above 0 on: a reading then stands for one
  // load.
  static absl::StatusOr<GainCurve> Make(std::vector<GainPoint> points);

  double Load(double reading) const;
  const std::vector<GainPoint>& points() const { return points_; }

  bool operator==(const GainCurve&) const = default;

 private:
  explicit GainCurve(std::vector<GainPoint> points)
      : points_(std::move(points)) {}

  std::vector<GainPoint> points_;
};

}  // namespace tactus::internal::client
