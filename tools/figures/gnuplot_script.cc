#include "tools/figures/gnuplot_script.h"

#include <array>
#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace tactus::internal::client {
namespace {

constexpr char kFont[] = "DejaVu Sans";
// gnuplot counts letters in points of 1/72 inch at 96 pixels per inch.
constexpr double kPointsPerPixel = 0.75;
constexpr double kBoldWidth = 1.16;

// Advance widths of ' ' to '~' in thousandths of the letters' size.
constexpr std::array<uint16_t, 95> kAdvance = {
    318, 401, 460, 838, 636, 950, 780, 275, 390,
    390, 500, 838,  //  !"#$%&'()*+
    318, 361, 318, 337, 636, 636, 636, 636, 636,
    636, 636, 636,                                 // ,-./01234567
    636, 636, 337, 337, 838, 838, 838, 531, 1000,  // 89:;<=>?@
    684, 686, 698, 770, 632, 575, 775, 752, 295,
    295, 656, 557,  // ABCDEFGHIJKL
    863, 748, 787, 603, 787, 695, 635, 611, 732,
    684, 989, 685,                           // MNOPQRSTUVWX
    611, 685, 390, 337, 390, 838, 500, 500,  // YZ[\]^_`
    613, 635, 550, 635, 615, 352, 635, 634, 278,
    278, 579, 278,  // abcdefghijkl
    974, 634, 612, 635, 635, 411, 521, 392, 634,
    592, 818, 592,                  // mnopqrstuvwx
    592, 525, 636, 337, 636, 838};  // yz{|}~

const char* NameOf(Align align) {
  switch (align) {
    case Align::kLeft:
      return "left";
    case Align::kCentre:
      return "center";
    case Align::kRight:
      return "right";
  }
  return "left";
}

}  // namespace

const char* SeriesColour(int index) {
  static constexpr const char* kColours[kMaxSeries] = {
      "#0072b2", "#d55e00", "#009e73", "#cc79a7",
      "#e69f00", "#56b4e9", "#444444"};
  return kColours[index % kMaxSeries];
}

int SeriesMarker(int index) {
  // Filled circle, square, triangle, diamond, triangle down, pentagon, star.
  static constexpr int kMarkers[kMaxSeries] = {7, 5, 9, 13, 11, 15, 3};
  return kMarkers[index % kMaxSeries];
}

int HollowMarker(int index) {
  // gnuplot numbers an outline directly before its filled form; the star has
  // none.
  const int marker = SeriesMarker(index);
  return marker == 3 ? marker : marker - 1;
}

double TextWidth(absl::string_view text, double size, bool bold) {
  double width = 0;
  for (const char c : text) {
    // The further bytes of a letter in UTF-8 take no room.
    if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;
    width += c >= ' ' && c <= '~' ? kAdvance[c - ' '] : 1000;
  }
  return width / 1000 * size * (bold ? kBoldWidth : 1);
}

std::string Shortened(absl::string_view text, double width, double size,
                      bool bold) {
  if (TextWidth(text, size, bold) <= width) return std::string(text);
  size_t length = text.size();
  const auto is_inside_letter = [&] {
    return (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80;
  };
  std::string shortened;
  do {
    if (length == 0) return "";
    --length;
    while (length > 0 && is_inside_letter()) --length;
    shortened = absl::StrCat(text.substr(0, length), "...");
  } while (TextWidth(shortened, size, bold) > width);
  return shortened;
}

std::string GnuplotText(absl::string_view text) {
  // Between single quotes gnuplot expands nothing; a typographic apostrophe
  // does not end the string.
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "\u2019";
    } else {
      quoted += absl::ascii_iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
    }
  }
  quoted += '\'';
  return quoted;
}

GnuplotScript::GnuplotScript(int width, int height)
    : width_(width), height_(height) {
  Add("set encoding utf8");
  Add("set terminal pngcairo size %d,%d font '%s,%g' noenhanced "
      "background rgb '#ffffff'",
      width, height, kFont, kTextSize * kPointsPerPixel);
  Add("unset key");
  Add("set border 3 lc rgb '%s' lw 2", kInk);
  Add("set tics nomirror out scale 0.6 textcolor rgb '%s'", kInk);
  Add("set grid lc rgb '%s' lt 1 lw 1.5", kGridInk);
  Add("set style fill solid 1 noborder");
}

void GnuplotScript::Data(absl::string_view name,
                         const std::vector<std::vector<double>>& rows) {
  absl::StrAppend(&text_, "$", name, " << EOD\n");
  for (const std::vector<double>& row : rows) {
    const char* separator = "";
    for (const double value : row) {
      absl::StrAppendFormat(&text_, "%s%.9g", separator, value);
      separator = " ";
    }
    text_ += '\n';
  }
  text_ += "EOD\n";
}

void GnuplotScript::PlotArea(const Box& area) {
  Add("set lmargin at screen %.6f", area.left / width_);
  Add("set rmargin at screen %.6f", area.right / width_);
  Add("set tmargin at screen %.6f", 1 - area.top / height_);
  Add("set bmargin at screen %.6f", 1 - area.bottom / height_);
}

void GnuplotScript::Text(absl::string_view text, Point at,
                         const TextStyle& style) {
  const double width = TextWidth(text, style.size, style.bold);
  const double before = style.align == Align::kLeft    ? 0
                        : style.align == Align::kRight ? width
                                                       : width / 2;
  const double half = style.size / 2;
  text_boxes_.push_back(style.vertical
                            ? Box{at.x - half, at.y - (width - before),
                                  at.x + half, at.y + before}
                            : Box{at.x - before, at.y - half,
                                  at.x - before + width, at.y + half});
  Add("set label %s at %s %s %s front font '%s%s,%g' textcolor rgb '%s'",
      GnuplotText(text), At(at), NameOf(style.align),
      style.vertical ? "rotate by 90" : "norotate", kFont,
      style.bold ? ":Bold" : "", style.size * kPointsPerPixel, style.colour);
}

void GnuplotScript::Line(Point from, Point to, absl::string_view style) {
  Add("set arrow from %s to %s nohead %s", At(from), At(to), style);
}

void GnuplotScript::ClearText() {
  Add("unset label");
  Add("unset arrow");
  Add("unset object");
}

std::string GnuplotScript::At(Point at) const {
  return absl::StrFormat("screen %.6f,%.6f", at.x / width_, 1 - at.y / height_);
}

}  // namespace tactus::internal::client
