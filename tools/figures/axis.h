// File: axis.h
//
// Axis: the x or y axis of a chart: its title, scale, ends and labels.
//
//   const Axis axis = {.title = "time since onset (s)",
//                      .scale = AxisScale::kLog};
//   const Range range = RangeShown(axis, {0.1, 5});
//   SetAxis('x', axis, range, script);
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tools/figures/gnuplot_script.h"

namespace tactus::internal::client {

enum class AxisScale { kLinear, kLog };

struct Range {
  double low = 0;
  double high = 1;
};

struct Axis {
  // Quantity and unit, e.g. "time since onset (s)".
  std::string title = {};
  AxisScale scale = AxisScale::kLinear;
  // Ends of the axis. Where absent, or where values lie beyond, the axis ends
  // shortly after the values: a chart hides none.
  std::optional<double> low = {};
  std::optional<double> high = {};
  // Values with a label; empty for round numbers.
  std::vector<double> ticks = {};
};

// INVALID_CONFIG that names the axis if there is no value, or if one of them is
// not finite or, on a logarithmic axis, not above 0.
absl::Status CheckValues(const Axis& axis, const std::vector<double>& values);

// The stretch of the axis that is drawn. `values` passed CheckValues.
Range RangeShown(const Axis& axis, const std::vector<double>& values);

// Where `value` is on the axis: 0 at its low end, 1 at its high end.
double PlaceOn(const Axis& axis, const Range& range, double value);

// Labels of a logarithmic axis, at most ten or so: powers of ten, with numbers
// between them on up to two decades and only every second, third... on more
// than ten. Fewer than two on ranges that are linear for all practical
// purposes.
std::vector<double> LogTicks(const Range& range);

// Sets scale, ends, title and labels of the axis `which`, 'x' or 'y'.
void SetAxis(char which, const Axis& axis, const Range& range,
             GnuplotScript& script);

}  // namespace tactus::internal::client
