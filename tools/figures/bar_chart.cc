#include "tools/figures/bar_chart.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/figures/sheet.h"

namespace tactus::internal::client {
namespace {

constexpr int kBarWidth = 1400;
// Heights of a section, of its name, and of the names of its groups.
constexpr int kSectionHeight = 330;
constexpr double kNameHeight = 44;
constexpr double kGroupNameHeight = 56;
// Height of the title of the groups, below the last section.
constexpr int kTitleHeight = 40;
// What the bars of a group take of its width.
constexpr double kGroupFill = 0.84;
constexpr double kValueSize = 19;

absl::Status Check(const BarChart& chart) {
  if (chart.series.empty() || chart.series.size() > kMaxSeries) {
    return InvalidConfig("series of a chart", chart.series.size(),
                         absl::StrCat("1 to ", kMaxSeries));
  }
  if (chart.sections.empty() || chart.sections.size() > kMaxBarSections) {
    return InvalidConfig("sections of a chart", chart.sections.size(),
                         absl::StrCat("1 to ", kMaxBarSections));
  }
  for (const BarSection& section : chart.sections) {
    const size_t bars = section.groups.size() * chart.series.size();
    if (bars == 0 || bars > kMaxBarsInRow) {
      return InvalidConfig(absl::StrCat("bars of section ", section.name), bars,
                           absl::StrCat("1 to ", kMaxBarsInRow));
    }
    for (const BarGroup& group : section.groups) {
      if (group.bars.size() == chart.series.size()) continue;
      return InvalidConfig(
          absl::StrCat("bars of group ", group.name), group.bars.size(),
          absl::StrCat(chart.series.size(), ", one per series"));
    }
  }
  return absl::OkStatus();
}

std::vector<double> AllValues(const BarChart& chart) {
  std::vector<double> values = {0};
  for (const ReferenceLine& line : chart.references) values.push_back(line.y);
  for (const BarSection& section : chart.sections) {
    for (const BarGroup& group : section.groups) {
      for (const auto& bar : group.bars) {
        if (!bar) continue;
        values.push_back(bar->value);
        if (bar->low) values.push_back(*bar->low);
        if (bar->high) values.push_back(*bar->high);
      }
    }
  }
  return values;
}

// One section on its own axes: group i spans i to i + 1.
void AddSection(const BarChart& chart, size_t index, const Range& y,
                const Box& area, GnuplotScript& script) {
  const BarSection& section = chart.sections[index];
  const int series = static_cast<int>(chart.series.size());
  const double groups = static_cast<double>(section.groups.size());
  const double bar_width = kGroupFill / series;
  script.Text(section.name, {area.left, area.top - kNameHeight / 2},
              {.bold = true});
  std::vector<std::string> names;
  std::vector<std::string> curves;
  for (int s = 0; s < series; ++s) {
    std::vector<std::vector<double>> rows;
    std::vector<std::vector<double>> intervals;
    for (size_t g = 0; g < section.groups.size(); ++g) {
      const std::optional<Bar>& bar = section.groups[g].bars[s];
      if (!bar) continue;
      const double x =
          static_cast<double>(g) + (1 - kGroupFill) / 2 + (s + 0.5) * bar_width;
      rows.push_back({x, bar->value});
      if (bar->low) intervals.push_back({x, bar->value, *bar->low, *bar->high});
      const double top = PlaceOn(chart.y, y, bar->high.value_or(bar->value));
      script.Text(absl::StrFormat("%.*f", chart.decimals, bar->value),
                  {area.left + x / groups * area.width(),
                   area.bottom - top * area.height() - 14},
                  {.size = kValueSize, .align = Align::kCentre});
    }
    // A block without rows is an error to gnuplot; this one is out of sight.
    if (rows.empty()) rows.push_back({-1, 0});
    const std::string name = absl::StrCat("bars", index, "_", s);
    script.Data(name, rows);
    curves.push_back(
        absl::StrFormat("$%s using 1:2:(%.9g) with boxes lc rgb '%s'", name,
                        0.94 * bar_width, SeriesColour(s)));
    if (intervals.empty()) continue;
    script.Data(name + "_interval", intervals);
    curves.push_back(absl::StrFormat("$%s_interval %s lc rgb '%s' lw 2.5", name,
                                     kIntervalBars, kInk));
  }
  for (const ReferenceLine& line : chart.references) {
    curves.push_back(absl::StrFormat("%.9g with lines lc rgb '%s' %s", line.y,
                                     kSoftInk, kDashes));
  }
  for (size_t g = 0; g < section.groups.size(); ++g) {
    names.push_back(absl::StrFormat(
        "%s %.1f", GnuplotText(section.groups[g].name), g + 0.5));
  }
  script.PlotArea(area);
  script.Add("set xrange [0:%g]", groups);
  script.Add("set xtics scale 0 (%s)", absl::StrJoin(names, ", "));
  script.Add("plot %s", absl::StrJoin(curves, ", \\\n  "));
  script.ClearText();
}

}  // namespace

absl::StatusOr<GnuplotScript> ScriptOf(const BarChart& chart) {
  TACTUS_RETURN_IF_ERROR(Check(chart));
  const std::vector<double> values = AllValues(chart);
  TACTUS_RETURN_IF_ERROR(CheckValues(chart.y, values));
  const double least = std::ranges::min(values);
  if (least < 0) return InvalidConfig("value of a bar", least, "at least 0");
  Heading heading = {.title = chart.title, .subtitle = chart.subtitle};
  for (const std::string& name : chart.series) {
    heading.legend.push_back(
        {.name = name,
         .sample = LegendSample::kBar,
         .index = static_cast<int>(heading.legend.size())});
  }
  for (const ReferenceLine& line : chart.references) {
    heading.legend.push_back(
        {.name = line.name, .sample = LegendSample::kDashes});
  }
  const int sections = static_cast<int>(chart.sections.size());
  const int heading_height = heading.subtitle.empty() ? 130 : 170;
  const int title_height = chart.x_title.empty() ? 0 : kTitleHeight;
  GnuplotScript script(
      kBarWidth, heading_height + sections * kSectionHeight + title_height);
  const Box area = AddHeading(heading, script, {.bottom = 8. + title_height});
  if (title_height > 0) {
    script.Text(chart.x_title,
                {(area.left + area.right) / 2, area.bottom + title_height / 2.},
                {.align = Align::kCentre});
  }
  Axis y = chart.y;
  y.low = 0;
  const Range range = RangeShown(y, values);
  SetAxis('y', y, range, script);
  script.Add("unset grid");
  script.Add("set grid ytics lc rgb '%s' lt 1 lw 1.5", kGridInk);
  script.Add("set multiplot");
  const double height = area.height() / sections;
  for (int i = 0; i < sections; ++i) {
    const double top = area.top + i * height;
    AddSection(chart, i, range,
               {area.left, top + kNameHeight, area.right,
                top + height - kGroupNameHeight},
               script);
  }
  script.Add("unset multiplot");
  return script;
}

}  // namespace tactus::internal::client
