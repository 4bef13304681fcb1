// File: ticks.h
//
// Round numbers for an axis, and as many of them as there is room for.
//
//   auto scale = MakeScale(axis, {.low = 0.13, .high = 4.9}, 6);
//   scale->ticks;          // 0, 1, 2, 3, 4, 5
//   scale->Position(2.5);  // 0.5
//   ThinTicks(200, [](const Tick& tick) { return WidthOf(tick); }, *scale);
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "client/tools/plot/figure.h"

namespace tactus::client {

struct Tick {
  double value = 0;
  std::string label;
};

struct DataRange {
  double low = 0;
  double high = 0;
};

// An axis with its ends and ticks settled.
struct PlotScale {
  AxisScale kind = AxisScale::kLinear;
  double low = 0;
  double high = 1;
  // Within [low, high], increasing.
  std::vector<Tick> ticks;
  // Without labels, in any order.
  std::vector<double> minor_ticks;
  // The ticks are the axis's own and stay.
  bool given = false;

  // 0 at `low`, 1 at `high`.
  double Position(double value) const;
};

// About `count` ticks; on a logarithmic axis of a decade or more 1, 2 and 5 of
// each. Ends that `axis` leaves open are round numbers at or beyond the data; a
// range of one value is widened. INVALID_CONFIG for ends that are not finite,
// not in order or, on a logarithmic axis, not above 0.
absl::StatusOr<PlotScale> MakeScale(const Axis& axis, const DataRange& data,
                                    int count);

// Leaves labels to every n-th tick or, on a logarithmic axis, to decades and to
// every n-th decade, n the smallest with which labels stand apart on an axis of
// `length`. extent: what a label takes up along the axis, with what is to be
// left free beside it, in the unit of `length`.
void ThinTicks(double length, absl::FunctionRef<double(const Tick&)> extent,
               PlotScale& scale);

// `value` with no more digits than it takes to tell multiples of `step`
// apart: "0.25", "2000", "5e6".
std::string TickLabel(double value, double step);

}  // namespace tactus::client
