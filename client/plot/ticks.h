// File: ticks.h
//
// Round numbers for an axis.
//
//   auto scale = MakeScale(axis, {.low = 0.13, .high = 4.9}, 6);
//   scale->ticks;          // 0, 1, 2, 3, 4, 5
//   scale->Position(2.5);  // 0.5
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/plot/figure.h"

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
  // Without labels; logarithmic axes only.
  std::vector<double> minor_ticks;

  // 0 at `low`, 1 at `high`.
  double Position(double value) const;
};

// About `count` ticks. Ends that `axis` leaves open are round numbers at or
// beyond the data; a range of one value is widened. INVALID_CONFIG for ends
// that are not finite, not in order or, on a logarithmic axis, not above 0.
absl::StatusOr<PlotScale> MakeScale(const Axis& axis, const DataRange& data,
                                    int count);

// `value` with no more digits than it takes to tell multiples of `step`
// apart: "0.25", "2000", "5e6".
std::string TickLabel(double value, double step);

}  // namespace tactus::client
