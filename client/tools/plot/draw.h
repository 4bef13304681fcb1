// File: draw.h
//
// Each kind of figure on a sheet of its own.
//
//   TACTUS_ASSIGN_OR_RETURN(Canvas canvas, Draw(plot));
//
// Errors are those of EncodePng. Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tools/plot/canvas.h"
#include "client/tools/plot/figure.h"
#include "client/tools/plot/ticks.h"

namespace tactus::client {

absl::StatusOr<Canvas> Draw(const LinePlot& plot);
absl::StatusOr<Canvas> Draw(const ScatterPlot& plot);
absl::StatusOr<Canvas> Draw(const BarChart& chart);
absl::StatusOr<Canvas> Draw(const ConfusionMatrix& matrix);

// INVALID_CONFIG unless there are 1 to kMaxSeries.
absl::Status CheckSeriesCount(size_t count);

// Smallest and largest of `values`; INVALID_CONFIG that names `what` if there
// is none or if one is not finite.
absl::StatusOr<DataRange> RangeOf(const std::vector<double>& values,
                                  const std::string& what);

}  // namespace tactus::client
