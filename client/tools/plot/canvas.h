// File: canvas.h
//
// What figures are drawn on: a white sheet measured in points, with lines,
// shapes and text. Drawn at kPixelsPerPoint and shrunk for output, so that
// every edge is smooth.
//
//   Canvas canvas(640, 400);
//   canvas.Line({10, 10}, {90, 10}, kInk, 1);
//   canvas.Text("force (N)", {50, 20}, {.align = Align::kMiddle});
//   auto png = canvas.EncodePng();
//
// x grows to the right, y downwards. Owns its pixels; one thread at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::client {

struct Point {
  double x = 0;
  double y = 0;
};

struct Box {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  double width() const { return right - left; }
  double height() const { return bottom - top; }
  bool Overlaps(const Box& other) const;
};

struct Colour {
  int red = 0;
  int green = 0;
  int blue = 0;
};

inline constexpr Colour kWhite = {255, 255, 255};
inline constexpr Colour kInk = {34, 34, 34};
inline constexpr Colour kSoftInk = {95, 95, 95};
inline constexpr Colour kGrid = {228, 228, 228};

// Colour of the index-th series; the palette of Okabe and Ito without its
// yellow, which is faint on white.
Colour SeriesColour(int index);

// `share` of the way from `a` to `b`.
Colour Mix(const Colour& a, const Colour& b, double share);

enum class Align { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 11;  // points
  Colour colour = kInk;
  bool bold = false;
  Align align = Align::kStart;
};

class Canvas {
 public:
  // Pixels of the written image per point, and of the drawing behind it.
  static constexpr int kOutputPixelsPerPoint = 2;
  static constexpr int kPixelsPerPoint = 6;

  // In points.
  Canvas(double width, double height);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  void Line(Point from, Point to, const Colour& colour, double width);
  void DashedLine(Point from, Point to, const Colour& colour, double width,
                  double dash, double gap);
  void Polyline(const std::vector<Point>& points, const Colour& colour,
                double width);
  void FillPolygon(const std::vector<Point>& points, const Colour& colour);
  void FillBox(const Box& box, const Colour& colour);
  void FillCircle(Point centre, double radius, const Colour& colour);

  // The shape of the index-th series, about `size` across, with a white rim
  // that sets it off from what lies below.
  void Marker(int index, Point centre, double size, const Colour& colour);

  // `at` is the middle of a capital letter's height. ASCII only.
  void Text(absl::string_view text, Point at, const TextStyle& style);
  // Reads from bottom to top, centred on `at`.
  void VerticalText(absl::string_view text, Point at, const TextStyle& style);
  static double TextWidth(absl::string_view text, const TextStyle& style);

  // IO if the encoder fails.
  absl::StatusOr<std::string> EncodePng() const;

 private:
  struct Pixels;
  std::unique_ptr<Pixels> pixels_;
};

}  // namespace tactus::client
