#include "tools/trainctl/data/contact_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "tools/common/class_words.h"
#include "tools/figures/axis.h"
#include "tools/trainctl/data/skin_strip.h"

namespace tactus::internal::client {
namespace {

// Columns of the sheet, in pixels. To the right of the axes stand the colour
// bar and the legend.
constexpr double kLeft = 150;
constexpr double kRight = 1290;
constexpr double kLegendLeft = kRight + 28;
constexpr double kAxisTitleX = 42;
// Rows, each with the space above it.
constexpr double kHeadingHeight = 128;
constexpr double kCaptionHeight = 34;
constexpr double kLeaderHeight = 44;
constexpr double kMarkRow = 34;
constexpr double kFeatureHeight = 140;
constexpr double kFeatureGap = 26;
constexpr double kPosteriorHeight = 270;
constexpr double kBelow = 96;
constexpr int kGap = 12;
constexpr int kPictureSpace =
    (static_cast<int>(kRight - kLeft) - (kSkinPictures - 1) * kGap) /
    kSkinPictures;
constexpr double kMaxPictureHeight = 200;
constexpr int kBarWidth = 26;

constexpr char kMarkLine[] = "lc rgb '#8a8a8a' lw 2";
constexpr char kUnknownColour[] = "#8a8a8a";

struct Panel {
  const char* title;
  Feature feature;
  double scale;
};

// Where the parts of the sheet are; computed once.
struct Sheet {
  bool with_skin = false;
  bool with_posteriors = false;
  double time_low = 0;
  double time_high = 0;
  double strip_top = 0;
  double strip_bottom = 0;
  // Force, area, motion.
  std::vector<Box> features;
  Box posteriors;
  int height = 0;
  // ShownClasses(), and the largest probability of those that are not shown.
  std::vector<int> classes;
  double largest_other = 0;

  // Colour of a class that is shown.
  const char* Colour(int class_index) const {
    return SeriesColour(static_cast<int>(
        std::ranges::find(classes, class_index) - classes.begin()));
  }
  double X(double seconds) const {
    return kLeft +
           (seconds - time_low) / (time_high - time_low) * (kRight - kLeft);
  }
};

// The classes whose posteriors are drawn, in order: all, if there are colours
// for them; else the label, the answer, the decision, and those with the
// largest probabilities.
std::vector<int> ShownClasses(const ContactTrace& trace) {
  std::vector<std::pair<double, int>> order;
  for (size_t k = 0; k < trace.probability.size(); ++k) {
    const int index = static_cast<int>(k);
    const bool named = trace.class_names[k] == trace.label ||
                       index == trace.Answer() ||
                       (trace.decision && index == trace.decision->class_index);
    order.emplace_back(-(named ? 2 : std::ranges::max(trace.probability[k])),
                       index);
  }
  std::ranges::stable_sort(order);
  order.resize(std::min<size_t>(order.size(), kMaxSeries));
  std::vector<int> classes;
  for (const auto& [key, index] : order) classes.push_back(index);
  std::ranges::sort(classes);
  return classes;
}

// `strip_height` is 0 without a skin.
Sheet LayOut(const ContactTrace& trace, double strip_height) {
  Sheet sheet;
  sheet.with_skin = strip_height > 0;
  sheet.with_posteriors = !trace.probability.empty();
  sheet.classes = ShownClasses(trace);
  for (size_t k = 0; k < trace.probability.size(); ++k) {
    if (std::ranges::find(sheet.classes, static_cast<int>(k)) ==
        sheet.classes.end()) {
      sheet.largest_other =
          std::max(sheet.largest_other, std::ranges::max(trace.probability[k]));
    }
  }
  sheet.time_high = trace.time.back();
  sheet.time_low = std::max(trace.time.front() - 1e-3,
                            -0.03 * std::max(0.1, sheet.time_high));
  sheet.time_low = std::min(sheet.time_low, 0.);
  double y = kHeadingHeight;
  if (sheet.with_skin) {
    sheet.strip_top = y + kCaptionHeight;
    sheet.strip_bottom = sheet.strip_top + strip_height;
    y = sheet.strip_bottom + kLeaderHeight;
  } else {
    y += kMarkRow;
  }
  for (int i = 0; i < kFeatureCount; ++i) {
    if (i > 0) y += kFeatureGap;
    sheet.features.push_back({kLeft, y, kRight, y + kFeatureHeight});
    y += kFeatureHeight;
  }
  if (sheet.with_posteriors) {
    y += kMarkRow + 10;
    sheet.posteriors = {kLeft, y, kRight, y + kPosteriorHeight};
    y += kPosteriorHeight;
  }
  sheet.height = static_cast<int>(y + kBelow);
  return sheet;
}

std::string AnswerLine(const ContactTrace& trace) {
  if (trace.probability.empty()) return "features only, no model";
  const int answer = trace.Answer();
  std::string line = absl::StrFormat("answer: %s, probability %.3f",
                                     DescribeClass(trace.class_names[answer]),
                                     trace.probability[answer].back());
  if (!trace.decision) {
    absl::StrAppend(&line, "; never decided");
  } else if (trace.decision->class_index == answer) {
    absl::StrAppendFormat(&line, "; decided %.2f s after onset",
                          trace.decision->seconds);
  } else {
    absl::StrAppendFormat(&line, "; decided %s %.2f s after onset",
                          trace.class_names[trace.decision->class_index],
                          trace.decision->seconds);
  }
  return line;
}

void AddHeading(const ContactTrace& trace, GnuplotScript& script) {
  std::string title = absl::StrCat("Trial ", trace.id);
  if (!trace.label.empty()) {
    absl::StrAppend(&title, ", label: ", DescribeClass(trace.label));
  }
  const double room = script.width() - 2 * kAxisTitleX;
  script.Text(Shortened(title, room, kTitleSize, /*bold=*/true),
              {kAxisTitleX, 44}, {.size = kTitleSize, .bold = true});
  std::string line = AnswerLine(trace);
  if (!trace.condition.empty()) {
    line = absl::StrCat("robot condition ", trace.condition, "; ", line);
  }
  script.Text(Shortened(line, room, kTextSize), {kAxisTitleX, 88},
              {.colour = kSoftInk});
}

std::string SecondsText(double seconds) {
  return absl::StrFormat("%.2f s", seconds);
}

// Round values from 0 to `largest`, three to six of them.
std::vector<double> RoundValues(double largest) {
  const double decade = std::pow(10., std::floor(std::log10(largest)));
  double step = decade;
  for (const double factor : {0.2, 0.5, 1., 2.}) {
    step = factor * decade;
    if (largest / step <= 5) break;
  }
  std::vector<double> values;
  for (int i = 0; i * step <= largest * (1 + 1e-9); ++i) {
    values.push_back(i * step);
  }
  return values;
}

void PlotPixels(const char* name, const Box& box, GnuplotScript& script) {
  script.PlotArea(box);
  script.Add("unset border");
  script.Add("unset tics");
  script.Add("plot [-0.5:%g] [%g:-0.5] $%s with rgbimage", box.width() - 0.5,
             box.height() - 0.5, name);
  script.ClearText();
}

void AddColourBar(const Sheet& sheet, double largest, const std::string& unit,
                  GnuplotScript& script) {
  const Box box = {kLegendLeft, sheet.strip_top, kLegendLeft + kBarWidth,
                   sheet.strip_bottom};
  const int height = static_cast<int>(box.height());
  std::vector<std::vector<double>> rows;
  for (int y = 0; y < height; ++y) {
    const Rgb colour = SkinColour(1 - y / (height - 1.));
    for (int x = 0; x < kBarWidth; ++x) {
      rows.push_back(
          {1. * x, 1. * y, 1. * colour[0], 1. * colour[1], 1. * colour[2]});
    }
  }
  script.Data("bar", rows);
  const std::vector<double> values = RoundValues(largest);
  // On a low bar only some of the values have a label.
  const double spacing = values[1] / largest * box.height();
  const size_t step =
      static_cast<size_t>(std::ceil(1.3 * kSmallSize / spacing));
  for (size_t i = 0; i < values.size(); i += step) {
    const double value = values[i];
    const double y = box.bottom - value / largest * box.height();
    script.Line({box.right, y}, {box.right + 8, y},
                absl::StrFormat("lc rgb '%s' lw 2", kInk));
    script.Text(absl::StrFormat("%g", value), {box.right + 16, y},
                {.size = kSmallSize});
  }
  script.Text(absl::StrFormat("force per taxel (%s)", unit),
              {kLegendLeft, box.top - 22}, {.size = kSmallSize});
  PlotPixels("bar", box, script);
}

// The strip, its captions, and lines from the pictures to their times.
void AddStrip(const ContactTrace& trace, const Sheet& sheet,
              const std::vector<size_t>& pictured, const SkinStrip& strip,
              GnuplotScript& script) {
  std::vector<std::vector<double>> rows;
  for (int y = 0; y < strip.height; ++y) {
    for (int x = 0; x < strip.width; ++x) {
      const Rgb& pixel = strip.At(x, y);
      rows.push_back(
          {1. * x, 1. * y, 1. * pixel[0], 1. * pixel[1], 1. * pixel[2]});
    }
  }
  script.Data("strip", rows);
  for (size_t i = 0; i < pictured.size(); ++i) {
    const double middle = kLeft + strip.lefts[i] + strip.picture_width / 2.;
    const double seconds = trace.time[pictured[i]];
    script.Text(SecondsText(seconds), {middle, sheet.strip_top - 18},
                {.size = kSmallSize, .align = Align::kCentre});
    script.Line({middle, sheet.strip_bottom + 5},
                {sheet.X(seconds), sheet.features[0].top - 2},
                "lc rgb '#b0b0b0' lw 1.5");
  }
  PlotPixels("strip",
             {kLeft, sheet.strip_top, kLeft + strip.width, sheet.strip_bottom},
             script);
}

// Lines through all panels at the onset, the release and the decision.
void AddMarks(const ContactTrace& trace, const Sheet& sheet,
              GnuplotScript& script) {
  const double top = sheet.features.front().top;
  const double bottom = sheet.with_posteriors ? sheet.posteriors.bottom
                                              : sheet.features.back().bottom;
  const double name_y = top - 16;
  script.Line({sheet.X(0), top}, {sheet.X(0), bottom}, kMarkLine);
  script.Text("onset", {sheet.X(0) - 8, name_y},
              {.size = kSmallSize, .colour = kSoftInk, .align = Align::kRight});
  if (trace.release_s) {
    const double x = sheet.X(*trace.release_s);
    script.Line({x, top}, {x, bottom}, kMarkLine);
    script.Text("release", {x + 8, name_y},
                {.size = kSmallSize, .colour = kSoftInk});
  }
  if (!trace.decision) return;
  const double x = sheet.X(trace.decision->seconds);
  const char* colour = sheet.Colour(trace.decision->class_index);
  script.Line({x, top}, {x, bottom},
              absl::StrFormat("lc rgb '%s' lw 2.5 dt (8,6)", colour));
  const std::string text = absl::StrFormat(
      "decision: %s, %s after onset",
      DescribeClass(trace.class_names[trace.decision->class_index]),
      SecondsText(trace.decision->seconds));
  // Beside the line, to the right of it if there is room.
  constexpr double kGapToLine = 12;
  const double width = TextWidth(text, kSmallSize, /*bold=*/true);
  const double room_right = kRight - x - kGapToLine;
  const double room_left = x - kGapToLine - kAxisTitleX;
  const bool right = width <= room_right || room_right >= room_left;
  script.Text(
      Shortened(text, right ? room_right : room_left, kSmallSize,
                /*bold=*/true),
      {x + (right ? kGapToLine : -kGapToLine), sheet.posteriors.top - 20},
      {.size = kSmallSize,
       .colour = colour,
       .bold = true,
       .align = right ? Align::kLeft : Align::kRight});
}

void PlotFeature(const Panel& panel, const ContactTrace& trace,
                 const Sheet& sheet, bool is_last, GnuplotScript& script) {
  const int index = static_cast<int>(panel.feature);
  const Box& box = sheet.features[index];
  std::vector<std::vector<double>> rows;
  std::vector<double> values = {0};
  for (size_t i = 0; i < trace.time.size(); ++i) {
    const double value = panel.scale * trace.features[i][index];
    rows.push_back({trace.time[i], value});
    values.push_back(value);
  }
  const std::string name = absl::StrCat("feature", index);
  script.Data(name, rows);
  script.PlotArea(box);
  Axis y;
  Range range = RangeShown(y, values);
  if (std::ranges::min(values) >= 0) range.low = 0;
  SetAxis('y', y, range, script);
  const std::vector<double> ticks = RoundValues(std::max(range.high, 1e-12));
  // Every other label where there would be more than four.
  script.Add("set ytics nomirror 0,%g", ticks[1] * (ticks.size() > 4 ? 2 : 1));
  script.Text(panel.title, {kAxisTitleX, (box.top + box.bottom) / 2},
              {.align = Align::kCentre, .vertical = true});
  if (!is_last) script.Add("set format x ''");
  script.Add("plot [%.9g:%.9g] $%s with lines lc rgb '%s' lw 3.5",
             sheet.time_low, sheet.time_high, name, "#333333");
  script.ClearText();
}

void AddPosteriorLegend(const ContactTrace& trace, const Sheet& sheet,
                        GnuplotScript& script) {
  constexpr double kRow = 36;
  constexpr double kSample = 36;
  double y = sheet.posteriors.top + 18;
  const auto add = [&](const std::string& name, const std::string& style) {
    script.Line({kLegendLeft, y}, {kLegendLeft + kSample, y}, style);
    const double left = kLegendLeft + kSample + 10;
    script.Text(Shortened(name, kContactPictureWidth - left - 6, kSmallSize),
                {left, y}, {.size = kSmallSize});
    y += kRow;
  };
  for (const int k : sheet.classes) {
    add(DescribeClass(trace.class_names[k]),
        absl::StrFormat("lc rgb '%s' lw 5", sheet.Colour(k)));
  }
  add("unknown", absl::StrFormat("lc rgb '%s' lw 3 dt (8,6)", kUnknownColour));
  const size_t others = trace.class_names.size() - sheet.classes.size();
  if (others == 0) return;
  script.Text(
      absl::StrFormat("%d others: at most %.2g", others, sheet.largest_other),
      {kLegendLeft, y}, {.size = kSmallSize, .colour = kSoftInk});
}

void PlotPosteriors(const ContactTrace& trace, const Sheet& sheet,
                    GnuplotScript& script) {
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < trace.time.size(); ++i) {
    rows.push_back({trace.time[i]});
    for (const auto& probability : trace.probability) {
      rows.back().push_back(probability[i]);
    }
    rows.back().push_back(trace.unknown[i]);
  }
  script.Data("posteriors", rows);
  const int classes = static_cast<int>(trace.probability.size());
  std::vector<std::string> curves = {absl::StrFormat(
      "$posteriors using 1:%d with lines lc rgb '%s' lw 3 dt (8,6)",
      classes + 2, kUnknownColour)};
  for (const int k : sheet.classes) {
    curves.push_back(
        absl::StrFormat("$posteriors using 1:%d with lines lc rgb '%s' lw 5",
                        k + 2, sheet.Colour(k)));
  }
  if (trace.decision) {
    const int k = trace.decision->class_index;
    const auto at =
        std::ranges::lower_bound(trace.time, trace.decision->seconds - 1e-9);
    const size_t frame =
        std::min<size_t>(at - trace.time.begin(), trace.time.size() - 1);
    script.Data("decision", {{trace.time[frame], trace.probability[k][frame]}});
    curves.push_back(absl::StrFormat(
        "$decision with points lc rgb '%s' pt 7 ps 3", sheet.Colour(k)));
  }
  const Box& box = sheet.posteriors;
  script.PlotArea(box);
  SetAxis('y', {}, {-0.02, 1.02}, script);
  script.Add("set ytics nomirror 0,0.25");
  script.Text("probability", {kAxisTitleX, (box.top + box.bottom) / 2},
              {.align = Align::kCentre, .vertical = true});
  AddPosteriorLegend(trace, sheet, script);
  script.Add("plot [%.9g:%.9g] %s", sheet.time_low, sheet.time_high,
             absl::StrJoin(curves, ", \\\n  "));
  script.ClearText();
}

double LargestTaxel(const ContactTrace& trace) {
  double largest = trace.layout.onset_threshold;
  for (const std::vector<float>& frame : trace.frames) {
    largest = std::max<double>(largest, std::ranges::max(frame));
  }
  return largest;
}

}  // namespace

std::string DescribeClass(absl::string_view name) {
  const std::string words = ClassWords(name);
  return words == name ? words : absl::StrCat(words, " (", name, ")");
}

std::vector<size_t> PicturedFrames(const ContactTrace& trace) {
  const double end = trace.release_s.value_or(trace.time.back());
  const auto at_or_after = [&](double seconds) {
    return std::ranges::lower_bound(trace.time, seconds - 1e-9) -
           trace.time.begin();
  };
  // The onset is the first frame after time 0.
  const auto first = std::ranges::upper_bound(trace.time, 1e-9);
  const double begin = trace.time[first - trace.time.begin()];
  std::vector<size_t> frames;
  for (int i = 0; i < kSkinPictures; ++i) {
    const double part = static_cast<double>(i) / (kSkinPictures - 1);
    const size_t frame =
        at_or_after(begin + std::pow(part, 1.6) * (end - begin));
    if (frames.empty() || frame > frames.back()) frames.push_back(frame);
  }
  return frames;
}

GnuplotScript ScriptOf(const ContactTrace& trace) {
  std::optional<SkinStrip> strip;
  std::vector<size_t> pictured;
  const bool with_skin = !trace.frames.empty();
  const double largest = with_skin ? LargestTaxel(trace) : 1;
  if (with_skin) {
    pictured = PicturedFrames(trace);
    std::vector<std::span<const float>> frames;
    for (const size_t i : pictured) frames.emplace_back(trace.frames[i]);
    strip = DrawSkinStrip(
        trace.layout, WindowAround(trace.layout, trace.frames), frames, largest,
        {kPictureSpace, static_cast<int>(kMaxPictureHeight), kGap});
  }
  const Sheet sheet = LayOut(trace, strip ? strip->height : 0);
  GnuplotScript script(kContactPictureWidth, sheet.height);
  script.Add("set multiplot");
  AddHeading(trace, script);
  if (strip) {
    AddStrip(trace, sheet, pictured, *strip, script);
    AddColourBar(sheet, largest, trace.unit, script);
  }
  script.Add("set border 3");
  script.Add("set tics nomirror out scale 0.6");
  script.Add("set xtics nomirror autofreq");
  const std::string force = absl::StrFormat("force (%s)", trace.unit);
  const Panel panels[] = {{force.c_str(), Feature::kForce, 1},
                          {"area (cm\u00b2)", Feature::kArea, 1e4},
                          {"motion (mm)", Feature::kMotion, 1e3}};
  AddMarks(trace, sheet, script);
  const char* time_title = "set xlabel 'time since onset (s)'";
  for (const Panel& panel : panels) {
    const bool is_last =
        panel.feature == Feature::kMotion && !sheet.with_posteriors;
    if (is_last) script.Add("set format x '%%g'");
    if (is_last) script.Add("%s", time_title);
    PlotFeature(panel, trace, sheet, is_last, script);
  }
  if (sheet.with_posteriors) {
    script.Add("set format x '%%g'");
    script.Add("%s", time_title);
    PlotPosteriors(trace, sheet, script);
  }
  script.Add("unset multiplot");
  return script;
}

}  // namespace tactus::internal::client
