#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/plot/draw.h"
#include "client/tools/plot/frame.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr double kHeight = 390;
constexpr double kMinWidth = 380;
constexpr double kMinBar = 16;
constexpr double kGroupGap = 12;
constexpr double kSectionGap = 16;
// Beside the plot: axis, its title and the margins.
constexpr double kAround = 90;
constexpr TextStyle kValueStyle = {.size = 8.5, .align = Align::kMiddle};
constexpr TextStyle kGroupStyle = {.size = kTickSize, .align = Align::kMiddle};
constexpr TextStyle kSectionStyle = {
    .size = kAxisTitleSize, .bold = true, .align = Align::kMiddle};

size_t GroupCount(const BarChart& chart) {
  size_t count = 0;
  for (const BarSection& section : chart.sections) {
    count += section.groups.size();
  }
  return count;
}

absl::Status Check(const BarChart& chart) {
  TACTUS_RETURN_IF_ERROR(CheckSeriesCount(chart.series.size()));
  const size_t groups = GroupCount(chart);
  if (groups * chart.series.size() > kMaxBars) {
    return InvalidConfig("number of bars", groups * chart.series.size(),
                         absl::StrCat("at most ", kMaxBars));
  }
  for (const BarSeries& series : chart.series) {
    if (series.values.size() != groups) {
      return InvalidConfig(absl::StrCat("values of \"", series.name, "\""),
                           series.values.size(),
                           absl::StrCat("one for each of ", groups, " groups"));
    }
    for (const auto& value : series.values) {
      if (value && *value < 0) {
        return InvalidConfig(absl::StrCat("value of \"", series.name, "\""),
                             *value, "0 or more");
      }
    }
  }
  return absl::OkStatus();
}

bool HasHeadings(const BarChart& chart) {
  return std::any_of(chart.sections.begin(), chart.sections.end(),
                     [](const BarSection& s) { return !s.name.empty(); });
}

std::string ValueText(const BarChart& chart, double value) {
  return absl::StrFormat("%.*f", chart.decimals, value);
}

// Wide enough for the values and the names of groups.
struct BarLayout {
  double bar = kMinBar;
  double group = 0;
  double section_gap = kSectionGap;

  explicit BarLayout(const BarChart& chart) {
    for (const BarSeries& series : chart.series) {
      for (const auto& value : series.values) {
        if (!value) continue;
        bar = std::max(
            bar, Canvas::TextWidth(ValueText(chart, *value), kValueStyle) + 2);
      }
    }
    group = bar * static_cast<double>(chart.series.size()) + kGroupGap;
    for (const BarSection& section : chart.sections) {
      for (const std::string& name : section.groups) {
        group = std::max(group, Canvas::TextWidth(name, kGroupStyle) + 6);
      }
    }
    // Few bars share the room of the narrowest figure.
    const double stretch =
        std::clamp((kMinWidth - kAround) / Width(chart), 1.0, 2.0);
    bar *= stretch;
    group *= stretch;
    section_gap *= stretch;
  }

  double Width(const BarChart& chart) const {
    return group * static_cast<double>(GroupCount(chart)) +
           section_gap * static_cast<double>(chart.sections.size());
  }
};

std::vector<LegendEntry> Legend(const BarChart& chart) {
  std::vector<LegendEntry> legend;
  for (const BarSeries& series : chart.series) {
    legend.push_back({.name = series.name,
                      .kind = LegendEntry::Kind::kBox,
                      .index = static_cast<int>(legend.size())});
  }
  for (size_t i = 0; i < chart.references.size(); ++i) {
    legend.push_back({.name = chart.references[i].name,
                      .kind = LegendEntry::Kind::kDashed,
                      .index = static_cast<int>(i)});
  }
  return legend;
}

void DrawGroup(const BarChart& chart, size_t group, double middle,
               const BarLayout& layout, const PlotFrame& frame,
               Canvas& canvas) {
  const double count = static_cast<double>(chart.series.size());
  for (size_t s = 0; s < chart.series.size(); ++s) {
    const double left =
        middle + (static_cast<double>(s) - count / 2) * layout.bar;
    const double centre = left + layout.bar / 2;
    const auto& value = chart.series[s].values[group];
    if (!value) {
      canvas.Text("n/a", {centre, frame.plot().bottom - kValueStyle.size},
                  {.size = kValueStyle.size,
                   .colour = kSoftInk,
                   .align = Align::kMiddle});
      continue;
    }
    const double top = frame.AtY(*value);
    canvas.FillBox(
        {left + 0.8, top, left + layout.bar - 0.8, frame.plot().bottom},
        SeriesColour(static_cast<int>(s)));
    canvas.Text(ValueText(chart, *value), {centre, top - 6}, kValueStyle);
  }
}

}  // namespace

absl::StatusOr<Canvas> Draw(const BarChart& chart) {
  TACTUS_RETURN_IF_ERROR(Check(chart));
  std::vector<double> values = {0};
  for (const BarSeries& series : chart.series) {
    for (const auto& value : series.values) {
      if (value) values.push_back(*value);
    }
  }
  for (const ReferenceLine& line : chart.references) values.push_back(line.y);
  TACTUS_ASSIGN_OR_RETURN(const DataRange range, RangeOf(values, "bars"));
  if (chart.y.scale == AxisScale::kLog || GroupCount(chart) == 0) {
    return InvalidConfig("bars", "none or a logarithmic axis",
                         "at least 1 group on a linear axis");
  }
  FrameSpec spec = {.title = chart.title,
                    .y_title = chart.y.title,
                    .legend = Legend(chart),
                    .extra_top = 6,
                    .extra_bottom = kTickSize + 6 +
                                    (HasHeadings(chart) ? kTickSize + 20 : 0)};
  TACTUS_ASSIGN_OR_RETURN(spec.y, MakeScale(chart.y, range, 6));
  const BarLayout layout(chart);
  const double width = std::max(kMinWidth, layout.Width(chart) + kAround);
  Canvas canvas(width, kHeight);
  const PlotFrame frame(canvas, width, kHeight, spec);

  const double spare = frame.plot().width() - layout.Width(chart);
  double left =
      frame.plot().left + std::max(0.0, spare) / 2 + layout.section_gap / 2;
  const double label_y = frame.plot().bottom + 5 + kTickSize / 2;
  size_t group = 0;
  for (const BarSection& section : chart.sections) {
    const double begin = left;
    for (const std::string& name : section.groups) {
      const double middle = left + layout.group / 2;
      DrawGroup(chart, group++, middle, layout, frame, canvas);
      canvas.Text(name, {middle, label_y}, kGroupStyle);
      left += layout.group;
    }
    if (!section.name.empty()) {
      const double rule = label_y + kTickSize / 2 + 6;
      canvas.Line({begin + 3, rule}, {left - 3, rule}, kSoftInk, 0.9);
      canvas.Text(section.name, {(begin + left) / 2, rule + 12}, kSectionStyle);
    }
    left += layout.section_gap;
  }
  for (size_t i = 0; i < chart.references.size(); ++i) {
    frame.DrawReference(canvas, static_cast<int>(i), chart.references[i].y);
  }
  return canvas;
}

}  // namespace tactus::client
