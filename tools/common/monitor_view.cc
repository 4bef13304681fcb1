#include "tools/common/monitor_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "absl/strings/str_format.h"
#include "tools/common/skin_heatmap.h"
#include "tools/common/text_canvas.h"

namespace tactus::internal::client {
namespace {

// Characters of the panel right of the heatmap, and between the two.
constexpr int kPanel = 30;
constexpr int kGap = 2;
constexpr int kNameWidth = 9;
constexpr int kValueWidth = 6;
constexpr int kMinClasses = 4;

constexpr int kDim = 245;
constexpr int kGood = 114;
constexpr int kBad = 203;
constexpr int kBar = 74;
constexpr int kUnknownBar = 179;

// Lines of text, one below the other.
class Panel {
 public:
  Panel(TextCanvas& canvas, int column, int row, bool colour)
      : canvas_(canvas), column_(column), row_(row), colour_(colour) {}

  void Line(const std::string& text, int colour = TextCanvas::kUsual) {
    canvas_.Text(column_, row_++, text, colour);
  }
  void Skip() { ++row_; }
  // A name, a bar and the fraction.
  void Bar(const std::string& name, double fraction, int colour) {
    const int width = kPanel - kNameWidth - kValueWidth - 1;
    canvas_.Text(column_, row_, name.substr(0, kNameWidth - 1));
    const int eighths =
        static_cast<int>(std::lround(std::clamp(fraction, 0., 1.) * width * 8));
    for (int i = 0; i < width; ++i) {
      const int part = std::clamp(eighths - 8 * i, 0, 8);
      if (colour_) {
        canvas_.Put(column_ + kNameWidth + i, row_, kEighths[part], colour,
                    kBack);
      } else {
        canvas_.Put(column_ + kNameWidth + i, row_, part >= 4 ? "#" : ".");
      }
    }
    canvas_.Text(column_ + kPanel - kValueWidth, row_++,
                 absl::StrFormat(" %.3f", fraction));
  }
  int row() const { return row_; }

 private:
  static constexpr int kBack = 236;
  static constexpr const char* kEighths[] = {" ", "▏", "▎", "▍", "▌",
                                             "▋", "▊", "▉", "█"};

  TextCanvas& canvas_;
  const int column_;
  int row_;
  const bool colour_;
};

const char* UnitOf(const MonitorState& state) {
  return state.layout.unit == TaxelUnit::kNewton ? "N" : "counts";
}

void ShowContact(const MonitorState& state, Panel& panel) {
  if (state.in_contact) {
    std::string line = absl::StrFormat("contact %d   %.2f s", state.contact_id,
                                       state.contact_s);
    if (state.contacts > 1) {
      absl::StrAppendFormat(&line, "   1 of %d", state.contacts);
    }
    panel.Line(line, kGood);
  } else {
    panel.Line(state.contact_id == 0
                   ? std::string("no contact yet")
                   : absl::StrFormat("no contact   (last: %d, %.2f s)",
                                     state.contact_id, state.contact_s),
               kDim);
  }
  panel.Line(absl::StrFormat("force %8.4g %s", state.max_force, UnitOf(state)));
  panel.Line(absl::StrFormat("area  %8d taxels %.1f cm2", state.area_taxels,
                             1e4 * state.area_m2));
  panel.Line(absl::StrFormat("motion%+8.1f mm", 1e3 * state.motion_m));
}

void ShowPosterior(const MonitorState& state, int rows, Panel& panel) {
  std::vector<size_t> order(state.probability.size());
  std::iota(order.begin(), order.end(), 0);
  const size_t room = static_cast<size_t>(std::max(rows - 2, kMinClasses));
  // Only the most probable ones if there is no room for all.
  if (order.size() > room) {
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      return state.probability[a] > state.probability[b];
    });
    order.resize(room);
  }
  for (const size_t k : order) {
    panel.Bar(state.class_names[k], state.probability[k], kBar);
  }
  panel.Bar("unknown", state.unknown, kUnknownBar);
  if (state.decision) {
    panel.Line(
        absl::StrFormat("decided %s after %.0f ms",
                        state.class_names[*state.decision], state.decision_ms),
        kGood);
  } else {
    panel.Line("undecided", kDim);
  }
}

std::string TimesText(const char* name, double p50, double p99) {
  if (p50 < 0) return absl::StrFormat("%-6s       -", name);
  return absl::StrFormat("%-6s p50 %.1f, p99 %.1f ms", name, p50, p99);
}

void ShowConnection(const MonitorState& state, Panel& panel) {
  if (state.connected) {
    panel.Line(absl::StrFormat("rate  %8.2f of %g Hz", state.rate_hz,
                               state.configured_hz));
  } else {
    panel.Line("the skin sends no frames", kBad);
  }
  const uint64_t bad = state.lost + state.overwritten;
  panel.Line(absl::StrFormat("frames%8d", state.frames));
  panel.Line(absl::StrFormat("lost  %8d overwritten %d", state.lost,
                             state.overwritten),
             bad > 0 ? kBad : TextCanvas::kUsual);
  panel.Line(TimesText("age", state.age_p50_ms, state.age_p99_ms));
  if (!state.class_names.empty()) {
    panel.Line(TimesText("answer", state.answer_p50_ms, state.answer_p99_ms));
  }
}

void ShowScale(const MonitorState& state, const HeatmapArea& map, bool colour,
               TextCanvas& canvas) {
  constexpr int kWidth = 12;
  const int row = map.row + map.rows;
  canvas.Text(map.column, row, "0 ");
  for (int i = 0; i < kWidth; ++i) {
    const double fraction = static_cast<double>(i) / kWidth;
    if (colour) {
      canvas.Put(map.column + 2 + i, row, "█", HeatColour(fraction));
    } else {
      canvas.Put(map.column + 2 + i, row,
                 std::string(1, HeatCharacter(fraction)));
    }
  }
  canvas.Text(map.column + kWidth + 3, row,
              absl::StrFormat("%.3g %s", state.full_scale, UnitOf(state)));
}

}  // namespace

std::vector<std::string> RenderMonitor(const MonitorState& state,
                                       const ScreenStyle& style) {
  TextCanvas canvas(style.columns, style.rows);
  canvas.Text(0, 0, state.title, kGood);
  const int footer_row =
      style.rows - std::min<int>(style.rows, state.footer.size());
  constexpr int kFirstRow = 2;
  // The scale has a line below the heatmap.
  const HeatmapArea area = {.column = 0,
                            .row = kFirstRow,
                            .columns = style.columns - kPanel - kGap,
                            .rows = footer_row - kFirstRow - 2};
  if (area.columns > 0 && area.rows > 0 && !state.values.empty()) {
    const HeatmapArea map =
        DrawHeatmap(state.layout, state.values, state.full_scale, area,
                    style.colour, canvas);
    ShowScale(state, map, style.colour, canvas);
  }
  Panel panel(canvas, std::max(0, area.columns + kGap), kFirstRow,
              style.colour);
  constexpr int kContactRows = 5;
  constexpr int kConnectionRows = 6;
  ShowContact(state, panel);
  panel.Skip();
  if (!state.probability.empty()) {
    ShowPosterior(
        state, footer_row - kFirstRow - kContactRows - kConnectionRows, panel);
    panel.Skip();
  }
  if (panel.row() < footer_row) ShowConnection(state, panel);
  // The panel may be longer than a small terminal; the footer wins.
  for (size_t i = 0; i < state.footer.size(); ++i) {
    const int row = footer_row + static_cast<int>(i);
    canvas.Text(0, row, std::string(std::max(style.columns, 0), ' '));
    canvas.Text(0, row, state.footer[i]);
  }
  return canvas.Lines(style.colour);
}

}  // namespace tactus::internal::client
