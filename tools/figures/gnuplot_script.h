// File: gnuplot_script.h
//
// GnuplotScript: the text of one gnuplot script that draws one PNG file. It
// sets up the picture (size, font, colours of the frame) and offers the few
// things that every chart needs: quoted text, data blocks, places in pixels.
//
//   GnuplotScript script(1120, 800);
//   script.PlotArea({120, 100, 1080, 700});
//   script.Data("curve", {{0, 1}, {1, 3}});
//   script.Text("Force over time", {120, 40}, {.size = 30, .bold = true});
//   script.Add("plot $curve with lines lc rgb '%s'", SeriesColour(0));
//   TACTUS_RETURN_IF_ERROR(DrawToFile(script.text(), "force.png"));
//
// Places are pixels from the upper left corner, x to the right, y downwards.
// Sizes suit a picture that is shown at half its size. Owns its text; one
// thread at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

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
};

// Colours as gnuplot takes them.
inline constexpr char kInk[] = "#222222";
inline constexpr char kSoftInk[] = "#5f5f5f";
inline constexpr char kGridInk[] = "#e2e2e2";

// Line style of reference lines.
inline constexpr char kDashes[] = "lw 3 dt (14,10)";

// Draws the columns 3 and 4 of rows {x, y, low, high} as bars with caps.
// gnuplot's own style `yerrorbars` puts a white disc on each bar.
inline constexpr char kIntervalBars[] =
    "using 1:3:(0):($4-$3) with vectors heads size screen 0.006,90 fixed";

// Series that the palette can tell apart.
inline constexpr int kMaxSeries = 7;
// Colour of the index-th series: the palette of Okabe and Ito (2008), which
// colour-blind readers tell apart, without its yellow, which is faint on white.
const char* SeriesColour(int index);
// gnuplot's number of the index-th series' marker.
int SeriesMarker(int index);
// The same marker as an outline.
int HollowMarker(int index);

// Heights of letters, in pixels.
inline constexpr double kTitleSize = 30;
inline constexpr double kTextSize = 24;
inline constexpr double kSmallSize = 20;

enum class Align { kLeft, kCentre, kRight };

struct TextStyle {
  double size = kTextSize;
  const char* colour = kInk;
  bool bold = false;
  Align align = Align::kLeft;
  // Reads from bottom to top; `align` then is along y.
  bool vertical = false;
};

// Width of `text` in pixels in DejaVu Sans, from its table of advance widths.
// Bytes that are not ASCII count as wide letters, so this never is too small.
double TextWidth(absl::string_view text, double size, bool bold = false);

// `text`, shortened to end in "..." if it is wider than `width` pixels.
std::string Shortened(absl::string_view text, double width, double size,
                      bool bold = false);

// `text` as a gnuplot string that nothing in it can end or expand. Control
// characters become spaces, apostrophes typographic ones.
std::string GnuplotText(absl::string_view text);

class GnuplotScript {
 public:
  // A white picture of this many pixels.
  GnuplotScript(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  const std::string& text() const { return text_; }

  // Appends one command, formatted as absl::StrFormat does.
  template <typename... Args>
  void Add(const absl::FormatSpec<Args...>& format, const Args&... args) {
    absl::StrAppendFormat(&text_, format, args...);
    text_ += '\n';
  }

  // Defines the data block $name, one line per row.
  void Data(absl::string_view name,
            const std::vector<std::vector<double>>& rows);

  // Where the axes of the next plot are.
  void PlotArea(const Box& area);

  // Text that starts, is centred or ends at `at`, whose other coordinate is the
  // middle of the letters. Belongs to the next plot; ClearText removes it
  // afterwards.
  void Text(absl::string_view text, Point at, const TextStyle& style);
  // A straight line with gnuplot's `style`, e.g. "lc rgb '#000000' lw 2".
  void Line(Point from, Point to, absl::string_view style);
  void ClearText();
  // What the texts so far cover, in their order.
  const std::vector<Box>& text_boxes() const { return text_boxes_; }

  // "screen 0.1,0.9" for a place in pixels.
  std::string At(Point at) const;

 private:
  int width_;
  int height_;
  std::string text_;
  std::vector<Box> text_boxes_;
};

}  // namespace tactus::internal::client
