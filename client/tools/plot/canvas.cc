#include "client/tools/plot/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/strings/ascii.h"
#include "client/tools/plot/figure.h"
#include "core/base/errors.h"
#include "opencv2/core.hpp"
#include "opencv2/imgcodecs.hpp"
#include "opencv2/imgproc.hpp"

namespace tactus::client {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
// Height of a capital letter: of this font at scale 1, and per point of size.
constexpr double kFontCapital = 21;
constexpr double kCapital = 0.68;
// Bits of a pixel's fraction in OpenCV's drawing functions.
constexpr int kShift = 4;

cv::Scalar ToScalar(const Colour& colour) {
  return cv::Scalar(colour.blue, colour.green, colour.red);
}

cv::Point ToFixed(Point point) {
  constexpr double kFactor = Canvas::kPixelsPerPoint * (1 << kShift);
  return {static_cast<int>(std::lround(point.x * kFactor)),
          static_cast<int>(std::lround(point.y * kFactor))};
}

int ToPixels(double points) {
  return static_cast<int>(std::lround(points * Canvas::kPixelsPerPoint));
}

std::vector<cv::Point> ToFixed(const std::vector<Point>& points) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (Point point : points) fixed.push_back(ToFixed(point));
  return fixed;
}

double FontScale(const TextStyle& style) {
  return style.size * kCapital * Canvas::kPixelsPerPoint / kFontCapital;
}

int StrokeWidth(const TextStyle& style) {
  const double share = style.bold ? 0.105 : 0.075;
  return std::max(1, ToPixels(style.size * share));
}

// The font's hyphen is as long as its minus sign: inside words a shorter one
// is drawn instead.
bool IsHyphen(absl::string_view text, size_t i) {
  return text[i] == '-' && i > 0 && i + 1 < text.size() &&
         absl::ascii_isalnum(text[i - 1]) && absl::ascii_isalnum(text[i + 1]);
}

// Writes from the base point on, or only measures if there is no image.
// Returns the width in pixels.
int WriteText(absl::string_view text, cv::Point base, const TextStyle& style,
              cv::Mat* image) {
  const double scale = FontScale(style);
  const int stroke = StrokeWidth(style);
  const cv::Scalar colour = ToScalar(style.colour);
  const int hyphen = ToPixels(style.size * 0.26);
  const int gap = ToPixels(style.size * 0.1);
  int x = base.x;
  for (size_t begin = 0; begin < text.size();) {
    if (IsHyphen(text, begin)) {
      const int y = base.y - ToPixels(style.size * kCapital * 0.4);
      if (image != nullptr) {
        cv::line(*image, {x + gap, y}, {x + gap + hyphen, y}, colour, stroke,
                 cv::LINE_AA);
      }
      x += hyphen + 2 * gap;
      ++begin;
      continue;
    }
    size_t end = begin + 1;
    while (end < text.size() && !IsHyphen(text, end)) ++end;
    const std::string part(text.substr(begin, end - begin));
    if (image != nullptr) {
      cv::putText(*image, part, {x, base.y}, kFont, scale, colour, stroke,
                  cv::LINE_AA);
    }
    x += cv::getTextSize(part, kFont, scale, stroke, nullptr).width;
    begin = end;
  }
  return x - base.x;
}

// Corners of a regular polygon, the first of them at `turn` circles from the
// top, clockwise.
std::vector<Point> Regular(int corners, Point centre, double radius,
                           double turn) {
  std::vector<Point> points;
  for (int i = 0; i < corners; ++i) {
    const double angle =
        2 * std::numbers::pi * (turn + static_cast<double>(i) / corners);
    points.push_back({centre.x + radius * std::sin(angle),
                      centre.y - radius * std::cos(angle)});
  }
  return points;
}

struct MarkerShape {
  int corners;  // 0 for a circle
  double turn;
  // Radius per size, so that all look equally large.
  double radius;
};
constexpr std::array<MarkerShape, kMaxSeries> kMarkers = {
    MarkerShape{0, 0, 0.5},    MarkerShape{4, 0.125, 0.62},
    MarkerShape{3, 0, 0.66},   MarkerShape{4, 0, 0.66},
    MarkerShape{3, 0.5, 0.66}, MarkerShape{6, 0, 0.56},
    MarkerShape{5, 0, 0.58}};

}  // namespace

struct Canvas::Pixels {
  cv::Mat image;
};

bool Box::Overlaps(const Box& other) const {
  return left < other.right && other.left < right && top < other.bottom &&
         other.top < bottom;
}

Colour SeriesColour(int index) {
  constexpr std::array<Colour, kMaxSeries> kPalette = {
      Colour{0, 114, 178},   Colour{213, 94, 0},  Colour{0, 158, 115},
      Colour{204, 121, 167}, Colour{230, 159, 0}, Colour{86, 180, 233},
      Colour{60, 60, 60}};
  return kPalette[index % kPalette.size()];
}

Colour Mix(const Colour& a, const Colour& b, double share) {
  const auto mix = [share](int x, int y) {
    return static_cast<int>(std::lround(x + share * (y - x)));
  };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Canvas::Canvas(double width, double height)
    : pixels_(std::make_unique<Pixels>()) {
  // A multiple of the shrinking factor, so that no pixel is cut.
  const auto size = [](double points) {
    return static_cast<int>(std::ceil(points)) * kPixelsPerPoint;
  };
  pixels_->image =
      cv::Mat(size(height), size(width), CV_8UC3, ToScalar(kWhite));
}

Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

void Canvas::Line(Point from, Point to, const Colour& colour, double width) {
  cv::line(pixels_->image, ToFixed(from), ToFixed(to), ToScalar(colour),
           std::max(1, ToPixels(width)), cv::LINE_AA, kShift);
}

void Canvas::DashedLine(Point from, Point to, const Colour& colour,
                        double width, double dash, double gap) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const auto at = [&](double s) {
    const double share = std::min(1.0, s / length);
    return Point{from.x + share * (to.x - from.x),
                 from.y + share * (to.y - from.y)};
  };
  for (double s = 0; s < length; s += dash + gap) {
    Line(at(s), at(s + dash), colour, width);
  }
}

void Canvas::Polyline(const std::vector<Point>& points, const Colour& colour,
                      double width) {
  cv::polylines(pixels_->image, std::vector{ToFixed(points)}, false,
                ToScalar(colour), std::max(1, ToPixels(width)), cv::LINE_AA,
                kShift);
}

void Canvas::FillPolygon(const std::vector<Point>& points,
                         const Colour& colour) {
  cv::fillPoly(pixels_->image, std::vector{ToFixed(points)}, ToScalar(colour),
               cv::LINE_AA, kShift);
}

void Canvas::FillBox(const Box& box, const Colour& colour) {
  FillPolygon({{box.left, box.top},
               {box.right, box.top},
               {box.right, box.bottom},
               {box.left, box.bottom}},
              colour);
}

void Canvas::FillCircle(Point centre, double radius, const Colour& colour) {
  cv::circle(
      pixels_->image, ToFixed(centre),
      static_cast<int>(std::lround(radius * kPixelsPerPoint * (1 << kShift))),
      ToScalar(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::Marker(int index, Point centre, double size,
                    const Colour& colour) {
  constexpr double kRim = 0.8;
  const MarkerShape& shape = kMarkers[index % kMarkers.size()];
  const double radius = size * shape.radius;
  if (shape.corners == 0) {
    FillCircle(centre, radius + kRim, kWhite);
    FillCircle(centre, radius, colour);
    return;
  }
  // Corners move out further than sides for a rim of even width.
  const double corner = kRim / std::cos(std::numbers::pi / shape.corners);
  FillPolygon(Regular(shape.corners, centre, radius + corner, shape.turn),
              kWhite);
  FillPolygon(Regular(shape.corners, centre, radius, shape.turn), colour);
}

double Canvas::TextWidth(absl::string_view text, const TextStyle& style) {
  return static_cast<double>(WriteText(text, {0, 0}, style, nullptr)) /
         kPixelsPerPoint;
}

void Canvas::Text(absl::string_view text, Point at, const TextStyle& style) {
  const double width = TextWidth(text, style);
  const double shift = style.align == Align::kStart    ? 0
                       : style.align == Align::kMiddle ? width / 2
                                                       : width;
  WriteText(
      text,
      {ToPixels(at.x - shift), ToPixels(at.y + style.size * kCapital / 2)},
      style, &pixels_->image);
}

void Canvas::VerticalText(absl::string_view text, Point at,
                          const TextStyle& style) {
  const int length = ToPixels(TextWidth(text, style) + style.size);
  const int height = ToPixels(2 * style.size);
  cv::Mat strip(height, length, CV_8UC3, ToScalar(kWhite));
  WriteText(text,
            {ToPixels(style.size / 2),
             (height + ToPixels(style.size * kCapital)) / 2},
            style, &strip);
  cv::rotate(strip, strip, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect place(ToPixels(at.x) - strip.cols / 2,
                       ToPixels(at.y) - strip.rows / 2, strip.cols, strip.rows);
  const cv::Rect inside =
      place & cv::Rect(0, 0, pixels_->image.cols, pixels_->image.rows);
  if (inside.empty()) return;
  cv::Mat target = pixels_->image(inside);
  // Ink is darker than paper: of the two the darker stays.
  cv::min(target, strip(inside - place.tl()), target);
}

absl::StatusOr<std::string> Canvas::EncodePng() const {
  constexpr int kShrink = kPixelsPerPoint / kOutputPixelsPerPoint;
  cv::Mat small;
  cv::resize(pixels_->image, small,
             {pixels_->image.cols / kShrink, pixels_->image.rows / kShrink}, 0,
             0, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", small, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6})) {
    return IoError("figure", "cannot be encoded as PNG");
  }
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace tactus::client
