// File: work_precision.h
//
// Work and precision of several methods at several tolerances, as a table and
// as a figure.
//
//   std::vector<WorkPoint> points = {
//       {"gentle", "CVODE", 1e-4, 0.003, 1e-4, 5e-3}};
//   TACTUS_RETURN_IF_ERROR(DrawFigure(WorkFigure(points), "sim.png"));
//
// Stateless; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "tools/figures/line_plot.h"

namespace tactus::internal::client {

struct WorkPoint {
  std::string sample;
  std::string method;
  double tolerance = 0;
  double seconds = 0;  // processor time of one contact, one core
  // Over the trials, each the largest of any feature and sample as a share of
  // the feature's peak.
  double median_error = 0;
  double worst_error = 0;
};

// sample,method,tolerance,seconds,median_error,worst_error as CSV.
std::string WorkTable(const std::vector<WorkPoint>& points);

// Worst errors, and of the first sample medians too, over time, both
// logarithmic, a line a method and sample; low and left is better. Times and
// errors are above 0.
LinePlot WorkFigure(const std::vector<WorkPoint>& points);

}  // namespace tactus::internal::client
