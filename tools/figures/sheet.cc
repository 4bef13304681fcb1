#include "tools/figures/sheet.h"

#include <algorithm>

#include "absl/strings/str_format.h"

namespace tactus::internal::client {
namespace {

constexpr double kSampleLength = 52;
constexpr double kMarkerLength = 24;
constexpr double kSampleGap = 12;
constexpr double kEntryGap = 36;
constexpr double kLegendRow = 1.5 * kTextSize;

bool IsMarker(LegendSample sample) {
  return sample == LegendSample::kMarker ||
         sample == LegendSample::kHollowMarker;
}

double SampleLength(LegendSample sample) {
  return IsMarker(sample) ? kMarkerLength : kSampleLength;
}

void AddSample(const LegendEntry& entry, Point left, GnuplotScript& script) {
  const double length = SampleLength(entry.sample);
  const Point right = {left.x + length, left.y};
  const Point middle = {left.x + length / 2, left.y};
  const char* colour = SeriesColour(entry.index);
  switch (entry.sample) {
    case LegendSample::kLineAndMarker:
    case LegendSample::kLine:
      script.Line(left, right, absl::StrFormat("lc rgb '%s' lw 4.5", colour));
      break;
    case LegendSample::kDashes:
      script.Line(left, right,
                  absl::StrFormat("lc rgb '%s' %s", kSoftInk, kDashes));
      break;
    case LegendSample::kBar:
      script.Add(
          "set object rectangle from %s to %s fc rgb '%s' fs solid 1 noborder",
          script.At({left.x + 8, left.y + 10}),
          script.At({right.x, left.y - 10}), colour);
      break;
    case LegendSample::kMarker:
    case LegendSample::kHollowMarker:
      break;
  }
  if (entry.sample == LegendSample::kLineAndMarker || IsMarker(entry.sample)) {
    script.Add("set label '' at %s point lc rgb '%s' lw 3 pt %d ps 2.6",
               script.At(middle), colour,
               entry.sample == LegendSample::kHollowMarker
                   ? HollowMarker(entry.index)
                   : SeriesMarker(entry.index));
  }
}

}  // namespace

double AddLegend(const std::vector<LegendEntry>& legend, Point from,
                 double right, GnuplotScript& script) {
  Point at = {from.x, from.y + kLegendRow / 2};
  for (const LegendEntry& entry : legend) {
    const double text_left = SampleLength(entry.sample) + kSampleGap;
    const double width = text_left + TextWidth(entry.name, kTextSize);
    if (at.x > from.x && at.x + width > right) {
      at = {from.x, at.y + kLegendRow};
    }
    AddSample(entry, at, script);
    script.Text(entry.name, {at.x + text_left, at.y}, {});
    at.x += width + kEntryGap;
  }
  return legend.empty() ? from.y : at.y + kLegendRow / 2;
}

Box AddHeading(const Heading& heading, GnuplotScript& script,
               const Margins& margins) {
  const double right = script.width() - margins.right;
  const double room = right - margins.left;
  double y = 44;
  script.Text(Shortened(heading.title, room, kTitleSize, /*bold=*/true),
              {margins.left, y}, {.size = kTitleSize, .bold = true});
  y += 0.8 * kTitleSize;
  if (!heading.subtitle.empty()) {
    y += 0.8 * kTextSize;
    script.Text(Shortened(heading.subtitle, room, kTextSize), {margins.left, y},
                {.colour = kSoftInk});
    y += 0.8 * kTextSize;
  }
  y = AddLegend(heading.legend, {margins.left, y + 4}, right, script);
  return {margins.left, y + 22, right, script.height() - margins.bottom};
}

}  // namespace tactus::internal::client
