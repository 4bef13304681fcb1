#include "client/tools/plot/ticks.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"

namespace tactus::client {
namespace {

// What rounding leaves of a multiple of a step.
constexpr double kSlack = 1e-9;

// 1, 2 or 5 times a power of ten, so that `span` holds about `count`.
double RoundStep(double span, int count) {
  const double rough = span / std::max(1, count);
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (double digit : {1.0, 2.0, 5.0}) {
    if (rough <= digit * power * (1 + kSlack)) return digit * power;
  }
  return 10 * power;
}

double LastPowerOfTen(double value) {
  return std::pow(10, std::floor(std::log10(value) + kSlack));
}

// The next of 1, 2 and 5 times a power of ten at or below `value`.
double RoundDown(double value) {
  const double power = LastPowerOfTen(value);
  for (double digit : {5.0, 2.0}) {
    if (value >= digit * power * (1 - kSlack)) return digit * power;
  }
  return power;
}

// The same at or above.
double RoundUp(double value) {
  const double power = LastPowerOfTen(value);
  for (double digit : {1.0, 2.0, 5.0}) {
    if (value <= digit * power * (1 + kSlack)) return digit * power;
  }
  return 10 * power;
}

// What the axis has to reach; a range of one value has no scale of its own.
DataRange Extent(const Axis& axis, const DataRange& data) {
  const DataRange all = {std::min(axis.low.value_or(data.low), data.low),
                         std::max(axis.high.value_or(data.high), data.high)};
  if (all.high > all.low) return all;
  if (axis.scale == AxisScale::kLog) return {all.low / 2, all.high * 2};
  const double margin = all.low == 0 ? 1 : std::abs(all.low) / 2;
  return {all.low - margin, all.high + margin};
}

// Less than a decade is divided as a linear axis is.
bool HasDecades(const PlotScale& scale) {
  return scale.kind == AxisScale::kLog &&
         scale.high >= 10 * scale.low * (1 - kSlack);
}

// All multiples of `step` within the scale.
void LaySteps(double step, PlotScale& scale) {
  const double last = std::floor(scale.high / step + kSlack);
  for (double k = std::ceil(scale.low / step - kSlack); k <= last; ++k) {
    scale.ticks.push_back({k * step, TickLabel(k * step, step)});
  }
}

void LayLinear(const Axis& axis, const DataRange& extent, int count,
               PlotScale& scale) {
  const double step = RoundStep(extent.high - extent.low, count);
  scale.low = extent.low == axis.low
                  ? extent.low
                  : std::floor(extent.low / step + kSlack) * step;
  scale.high = extent.high == axis.high
                   ? extent.high
                   : std::ceil(extent.high / step - kSlack) * step;
  LaySteps(step, scale);
}

void LayLog(const Axis& axis, const DataRange& extent, int count,
            PlotScale& scale) {
  scale.low = extent.low == axis.low ? extent.low : RoundDown(extent.low);
  scale.high = extent.high == axis.high ? extent.high : RoundUp(extent.high);
  if (!HasDecades(scale)) {
    LaySteps(RoundStep(scale.high - scale.low, count), scale);
    return;
  }
  const int first = static_cast<int>(std::floor(std::log10(scale.low)));
  const int last = static_cast<int>(std::ceil(std::log10(scale.high)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10, exponent);
      if (value < scale.low * (1 - kSlack) ||
          value > scale.high * (1 + kSlack)) {
        continue;
      }
      if (digit == 1 || digit == 2 || digit == 5) {
        scale.ticks.push_back({value, TickLabel(value, value)});
      } else {
        scale.minor_ticks.push_back(value);
      }
    }
  }
}

void LayGiven(const std::vector<double>& values, PlotScale& scale) {
  scale.ticks.clear();
  scale.minor_ticks.clear();
  scale.given = true;
  for (double value : values) {
    if (value < scale.low || value > scale.high) continue;
    scale.ticks.push_back({value, absl::StrFormat("%g", value)});
  }
}

bool LabelsTouch(const PlotScale& scale, double length,
                 absl::FunctionRef<double(const Tick&)> extent) {
  for (size_t i = 1; i < scale.ticks.size(); ++i) {
    const Tick& a = scale.ticks[i - 1];
    const Tick& b = scale.ticks[i];
    const double apart =
        (scale.Position(b.value) - scale.Position(a.value)) * length;
    if (apart < (extent(a) + extent(b)) / 2 * (1 - kSlack)) return true;
  }
  return false;
}

bool IsWhole(double number) {
  return std::abs(number - std::round(number)) < 1e-6;
}

}  // namespace

double PlotScale::Position(double value) const {
  if (kind == AxisScale::kLog) {
    return std::log(value / low) / std::log(high / low);
  }
  return (value - low) / (high - low);
}

absl::StatusOr<PlotScale> MakeScale(const Axis& axis, const DataRange& data,
                                    int count) {
  const double low = axis.low.value_or(data.low);
  const double high = axis.high.value_or(data.high);
  const bool finite = std::isfinite(low) && std::isfinite(high) &&
                      std::isfinite(data.low) && std::isfinite(data.high);
  if (!finite || (axis.low && axis.high && low >= high)) {
    return InvalidConfig(absl::StrCat("axis \"", axis.title, "\""),
                         absl::StrCat(low, " to ", high),
                         "finite ends in increasing order");
  }
  const DataRange extent = Extent(axis, data);
  if (axis.scale == AxisScale::kLog && extent.low <= 0) {
    return InvalidConfig(absl::StrCat("logarithmic axis \"", axis.title, "\""),
                         extent.low, "values above 0");
  }
  PlotScale scale;
  scale.kind = axis.scale;
  if (axis.scale == AxisScale::kLog) {
    LayLog(axis, extent, count, scale);
  } else {
    LayLinear(axis, extent, count, scale);
  }
  if (!axis.ticks.empty()) LayGiven(axis.ticks, scale);
  return scale;
}

void ThinTicks(double length, absl::FunctionRef<double(const Tick&)> extent,
               PlotScale& scale) {
  if (scale.given || scale.ticks.size() < 2) return;
  const std::vector<Tick> all = scale.ticks;
  const double step = all[1].value - all[0].value;
  for (int n = 1; LabelsTouch(scale, length, extent); ++n) {
    scale.ticks.clear();
    if (n > 1) scale.minor_ticks.clear();
    for (const Tick& tick : all) {
      const double number =
          HasDecades(scale) ? std::log10(tick.value) : tick.value / step;
      if (IsWhole(number / n)) {
        scale.ticks.push_back(tick);
      } else if (n == 1 || IsWhole(number)) {
        scale.minor_ticks.push_back(tick.value);
      }
    }
  }
}

std::string TickLabel(double value, double step) {
  // Not "-0".
  if (std::abs(value) < step / 2) return "0";
  if (std::abs(value) >= 1e6 || step < 1e-4) {
    return absl::StrReplaceAll(absl::StrFormat("%.3g", value),
                               {{"e+0", "e"}, {"e+", "e"}, {"e-0", "e-"}});
  }
  int decimals = 0;
  for (double rest = step; decimals < 6; ++decimals, rest *= 10) {
    if (std::abs(rest - std::round(rest)) <= kSlack * rest) break;
  }
  return absl::StrFormat("%.*f", decimals, value);
}

}  // namespace tactus::client
