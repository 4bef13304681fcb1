#include "client/tools/plot/frame.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tactus::client {
namespace {

constexpr double kMargin = 14;
constexpr double kTickLength = 4;
constexpr double kRowHeight = 18;
constexpr double kSwatchGap = 6;
constexpr double kEntryGap = 20;
// Left free between labels of ticks, side by side and above each other.
constexpr double kGapAcross = 12;
constexpr double kGapDown = 20;

constexpr TextStyle kLegendStyle = {.size = 11};
constexpr TextStyle kTickStyle = {.size = kTickSize, .colour = kInk};

// Reference lines differ in their dashes.
void DrawDashed(Point from, Point to, int index, Canvas& canvas) {
  struct Dash {
    double length;
    double gap;
  };
  constexpr std::array<Dash, 3> kDashes = {Dash{5.5, 5}, Dash{0.2, 3.8},
                                           Dash{11, 5}};
  const Dash& dash = kDashes[index % kDashes.size()];
  canvas.DashedLine(from, to, kSoftInk, 1.3, dash.length, dash.gap);
}

double SwatchWidth(const LegendEntry& entry) {
  switch (entry.kind) {
    case LegendEntry::Kind::kBox:
      return 13;
    case LegendEntry::Kind::kMarker:
      return 10;
    default:
      return 26;
  }
}

void DrawSwatch(const LegendEntry& entry, Point left, Canvas& canvas) {
  using Kind = LegendEntry::Kind;
  const Colour colour = SeriesColour(entry.index);
  const Point right = {left.x + SwatchWidth(entry), left.y};
  const Point middle = {(left.x + right.x) / 2, left.y};
  switch (entry.kind) {
    case Kind::kDashed:
      DrawDashed(left, right, entry.index, canvas);
      break;
    case Kind::kBox:
      canvas.FillBox({left.x, left.y - 6, right.x, left.y + 6}, colour);
      break;
    case Kind::kMarker:
      canvas.Marker(entry.index, middle, 8, colour);
      break;
    case Kind::kLine:
    case Kind::kLineWithMarker:
      canvas.Line(left, right, colour, 1.8);
      if (entry.kind == Kind::kLineWithMarker) {
        canvas.Marker(entry.index, middle, 7, colour);
      }
      break;
  }
}

double WidestLabel(const PlotScale& scale) {
  double widest = 0;
  for (const Tick& tick : scale.ticks) {
    widest = std::max(widest, Canvas::TextWidth(tick.label, kTickStyle));
  }
  return widest;
}

}  // namespace

double LayLegend(const std::vector<LegendEntry>& entries, Point top_left,
                 double width, Canvas* canvas) {
  if (entries.empty()) return 0;
  Point at = {top_left.x, top_left.y + kRowHeight / 2};
  for (const LegendEntry& entry : entries) {
    const double swatch = SwatchWidth(entry);
    const double needed =
        swatch + kSwatchGap + Canvas::TextWidth(entry.name, kLegendStyle);
    if (at.x > top_left.x && at.x + needed > top_left.x + width) {
      at = {top_left.x, at.y + kRowHeight};
    }
    if (canvas != nullptr) {
      DrawSwatch(entry, at, *canvas);
      canvas->Text(entry.name, {at.x + swatch + kSwatchGap, at.y},
                   kLegendStyle);
    }
    at.x += needed + kEntryGap;
  }
  return at.y + kRowHeight / 2 - top_left.y;
}

PlotFrame::PlotFrame(Canvas& canvas, double width, double height,
                     FrameSpec spec)
    : spec_(std::move(spec)) {
  plot_.left =
      kMargin + kAxisTitleSize + 14 + WidestLabel(spec_.y) + kTickLength + 3;
  // Half of the last label of the x axis stands beyond the plot.
  const double overhang =
      spec_.x.ticks.empty()
          ? 0
          : Canvas::TextWidth(spec_.x.ticks.back().label, kTickStyle) / 2;
  plot_.right = width - kMargin - std::max(4.0, overhang);
  double top = kMargin;
  if (!spec_.title.empty()) {
    TextStyle style = {.size = kTitleSize, .bold = true};
    const double length = Canvas::TextWidth(spec_.title, style);
    style.size *= std::min(1.0, (width - kMargin - plot_.left) / length);
    canvas.Text(spec_.title, {plot_.left, top + kTitleSize / 2}, style);
    top += kTitleSize + 10;
  }
  top += LayLegend(spec_.legend, {plot_.left, top}, plot_.width(), &canvas);
  plot_.top = top + 8 + spec_.extra_top;
  const double labels = spec_.x.ticks.empty() ? 0 : kTickLength + kTickSize + 6;
  const double title = spec_.x_title.empty() ? 0 : kAxisTitleSize + 8;
  plot_.bottom = height - kMargin - labels - title - spec_.extra_bottom;
  ThinTicks(
      plot_.width(),
      [](const Tick& tick) {
        return Canvas::TextWidth(tick.label, kTickStyle) + kGapAcross;
      },
      spec_.x);
  ThinTicks(
      plot_.height(), [](const Tick&) { return kTickSize + kGapDown; },
      spec_.y);

  for (const Tick& tick : spec_.y.ticks) {
    const double y = AtY(tick.value);
    canvas.Line({plot_.left, y}, {plot_.right, y}, kGrid, 0.8);
    canvas.Line({plot_.left - kTickLength, y}, {plot_.left, y}, kInk, 0.9);
    canvas.Text(tick.label, {plot_.left - kTickLength - 4, y},
                {.size = kTickSize, .align = Align::kEnd});
  }
  for (double value : spec_.y.minor_ticks) {
    const double y = AtY(value);
    canvas.Line({plot_.left - kTickLength / 2, y}, {plot_.left, y}, kInk, 0.6);
  }
  for (const Tick& tick : spec_.x.ticks) {
    const double x = AtX(tick.value);
    if (spec_.grid_x) {
      canvas.Line({x, plot_.top}, {x, plot_.bottom}, kGrid, 0.8);
    }
    canvas.Line({x, plot_.bottom}, {x, plot_.bottom + kTickLength}, kInk, 0.9);
    canvas.Text(tick.label, {x, plot_.bottom + kTickLength + 4 + kTickSize / 2},
                {.size = kTickSize, .align = Align::kMiddle});
  }
  for (double value : spec_.x.minor_ticks) {
    const double x = AtX(value);
    canvas.Line({x, plot_.bottom}, {x, plot_.bottom + kTickLength / 2}, kInk,
                0.6);
  }
  canvas.Line({plot_.left, plot_.top}, {plot_.left, plot_.bottom}, kInk, 0.9);
  canvas.Line({plot_.left, plot_.bottom}, {plot_.right, plot_.bottom}, kInk,
              0.9);
  canvas.VerticalText(
      spec_.y_title,
      {kMargin + kAxisTitleSize / 2, (plot_.top + plot_.bottom) / 2},
      {.size = kAxisTitleSize});
  canvas.Text(
      spec_.x_title,
      {(plot_.left + plot_.right) / 2, height - kMargin - kAxisTitleSize / 2},
      {.size = kAxisTitleSize, .align = Align::kMiddle});
}

double PlotFrame::AtX(double x) const {
  return plot_.left + spec_.x.Position(x) * plot_.width();
}

double PlotFrame::AtY(double y) const {
  return plot_.bottom - spec_.y.Position(y) * plot_.height();
}

Point PlotFrame::At(double x, double y) const { return {AtX(x), AtY(y)}; }

void PlotFrame::DrawReference(Canvas& canvas, int index, double y) const {
  DrawDashed({plot_.left, AtY(y)}, {plot_.right, AtY(y)}, index, canvas);
}

}  // namespace tactus::client
