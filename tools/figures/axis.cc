#include "tools/figures/axis.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

// Free stretch beyond the outermost values, as a fraction of their distance.
constexpr double kPadding = 0.05;

// "-12" in the superscript letters of Unicode.
std::string Superscript(int number) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴",
                                            "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : absl::StrCat(number)) {
    text += c == '-' ? "⁻" : kDigits[c - '0'];
  }
  return text;
}

// Powers of ten beyond four digits are written as such.
std::string PowerLabel(double value) {
  const double exponent = std::log10(value);
  if (std::abs(exponent - std::round(exponent)) < 1e-9 &&
      std::abs(exponent) > 3.5) {
    return absl::StrCat("10",
                        Superscript(static_cast<int>(std::lround(exponent))));
  }
  return absl::StrFormat("%g", value);
}

std::string TickList(const std::vector<double>& ticks) {
  // Numbers of up to six digits are all written alike.
  const bool plain = std::ranges::all_of(ticks, [](double tick) {
    return tick <= 0 || (tick > 0.9e-3 && tick < 1e6);
  });
  return absl::StrJoin(ticks, ", ", [&](std::string* out, double tick) {
    absl::StrAppendFormat(
        out, "'%s' %.9g",
        plain || tick <= 0 ? absl::StrCat(tick) : PowerLabel(tick), tick);
  });
}

}  // namespace

absl::Status CheckValues(const Axis& axis, const std::vector<double>& values) {
  if (values.empty()) {
    return InvalidConfig(axis.title, "no values", "at least one value");
  }
  for (const double value : values) {
    if (!std::isfinite(value)) {
      return InvalidConfig(axis.title, value, "a finite number");
    }
    if (axis.scale == AxisScale::kLog && value <= 0) {
      return InvalidConfig(axis.title, value, "above 0 on a logarithmic axis");
    }
  }
  return absl::OkStatus();
}

Range RangeShown(const Axis& axis, const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  Range range;
  if (axis.scale == AxisScale::kLog) {
    const double factor = most > least ? std::pow(most / least, kPadding) : 2;
    range = {least / factor, most * factor};
  } else {
    const double margin = most > least ? kPadding * (most - least)
                                       : std::max(0.5 * std::abs(most), 0.5);
    range = {least - margin, most + margin};
  }
  if (axis.low && *axis.low <= least) range.low = *axis.low;
  if (axis.high && *axis.high >= most) range.high = *axis.high;
  return range;
}

double PlaceOn(const Axis& axis, const Range& range, double value) {
  if (axis.scale == AxisScale::kLog) {
    return std::log(value / range.low) / std::log(range.high / range.low);
  }
  return (value - range.low) / (range.high - range.low);
}

std::vector<double> LogTicks(const Range& range) {
  const int first = static_cast<int>(std::floor(std::log10(range.low)));
  const int last = static_cast<int>(std::ceil(std::log10(range.high)));
  const double decades = std::log10(range.high / range.low);
  std::vector<double> factors = {1};
  if (decades <= 2) factors = {1, 2, 5};
  if (decades <= 0.9) factors = {1, 1.5, 2, 3, 4, 5, 6, 8};
  const int step = std::max(1, static_cast<int>(std::ceil(decades / 10)));
  std::vector<double> ticks;
  for (int decade = first; decade <= last; ++decade) {
    if (decade % step != 0) continue;
    for (const double factor : factors) {
      const double tick = factor * std::pow(10., decade);
      // Ends count although they may be rounded.
      if (tick < range.low * (1 - 1e-9) || tick > range.high * (1 + 1e-9)) {
        continue;
      }
      ticks.push_back(tick);
    }
  }
  return ticks;
}

void SetAxis(char which, const Axis& axis, const Range& range,
             GnuplotScript& script) {
  script.Add("set %crange [%.9g:%.9g]", which, range.low, range.high);
  script.Add("%s logscale %c", axis.scale == AxisScale::kLog ? "set" : "unset",
             which);
  script.Add("set %clabel %s textcolor rgb '%s'", which,
             GnuplotText(axis.title), kInk);
  std::vector<double> ticks = axis.ticks;
  if (ticks.empty() && axis.scale == AxisScale::kLog) ticks = LogTicks(range);
  if (ticks.size() < 2) {
    script.Add("set %ctics autofreq format '%%g'", which);
  } else {
    script.Add("set %ctics (%s)", which, TickList(ticks));
  }
}

}  // namespace tactus::internal::client
