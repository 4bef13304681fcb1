// File: axis_loads.h
//
// AxisLoads: what a taxel's readings above its baseline amount to along each
// axis, and the one load that thresholds are compared with, as
// core/skin/normal_loads.h defines it.
//
//   const AxisLoads loads(layout, calibration.cross_axis);
//   const AxisVector load = loads.Of(17, readings);
//   if (loads.Normal(load) >= contact_threshold) Touch(17);
//
// A taxel with a cross-axis matrix has loads in the layout's unit; without one
// they are its readings, in the numbers that the skin sends.
//
// Nothing but the constructor allocates. Immutable; thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "client/drivers/calibration/cross_axis.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

class AxisLoads {
 public:
  // `matrices` are none for a layout of one axis.
  AxisLoads(const SkinLayout& layout, CrossAxes matrices);

  size_t taxels() const { return taxels_; }
  size_t axes() const { return axes_; }
  // The axis that carries the load; nothing if it is the distance from 0.
  const std::optional<int>& normal_axis() const { return normal_; }
  // A load may be on either side of 0: the layout has three axes, or signs.
  bool both_ways() const { return both_ways_; }
  const CrossAxis* Matrix(size_t taxel) const {
    return MatrixOf(matrices_, taxel);
  }

  // The loads of a taxel; `readings` are those of the whole skin.
  AxisVector Of(size_t taxel, std::span<const double> readings) const;
  // The same of the taxel's own readings.
  AxisVector OfTaxel(size_t taxel, const AxisVector& reading) const;
  // The load of a taxel with these loads along the axes. Below 0 only on a skin
  // of one axis without signs.
  double Normal(const AxisVector& loads) const;
  // The most by which one step of one of the skin's numbers moves that load.
  double Step(size_t taxel) const;

 private:
  const size_t taxels_;
  const size_t axes_;
  const std::optional<int> normal_;
  const bool both_ways_;
  const CrossAxes matrices_;
};

}  // namespace tactus::internal::client
