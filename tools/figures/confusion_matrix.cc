#include "tools/figures/confusion_matrix.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/figures/sheet.h"

namespace tactus::internal::client {
namespace {

constexpr int kCellWidth = 140;
constexpr int kCellHeight = 110;
constexpr int kMinWidth = 4 * kCellWidth;
constexpr double kMaxLabelWidth = 170;
// The picture is as wide as its title and subtitle need, up to this.
constexpr int kMaxTextWidth = 900;
// Above this percentage a cell is dark and its text white.
constexpr double kDarkFrom = 0.5;

absl::Status Check(const ConfusionMatrix& matrix) {
  const size_t classes = matrix.labels.size();
  if (classes == 0 || classes > kMaxMatrixClasses) {
    return InvalidConfig("classes of a confusion matrix", classes,
                         absl::StrCat("1 to ", kMaxMatrixClasses));
  }
  const auto fits = [&](const std::vector<int>& row) {
    return row.size() == classes &&
           std::ranges::all_of(row, [](int count) { return count >= 0; });
  };
  if (matrix.counts.size() != classes ||
      !std::ranges::all_of(matrix.counts, fits)) {
    return InvalidConfig("counts of a confusion matrix", matrix.counts.size(),
                         "one row per class, of one count >= 0 per class");
  }
  return absl::OkStatus();
}

// From white at 0 to dark blue at 1.
std::string CellColour(double fraction) {
  constexpr int kDark[3] = {11, 74, 131};
  std::string colour = "#";
  for (const int dark : kDark) {
    absl::StrAppendFormat(
        &colour, "%02x",
        static_cast<int>(std::lround(255 + fraction * (dark - 255))));
  }
  return colour;
}

}  // namespace

absl::StatusOr<GnuplotScript> ScriptOf(const ConfusionMatrix& matrix) {
  TACTUS_RETURN_IF_ERROR(Check(matrix));
  const int classes = static_cast<int>(matrix.labels.size());
  double widest = 0;
  for (const std::string& label : matrix.labels) {
    widest = std::max(widest, TextWidth(label, kTextSize));
  }
  const Margins margins = {.left = 100 + std::min(widest, kMaxLabelWidth),
                           .right = 30,
                           .bottom = 106};
  const int heading_height = matrix.subtitle.empty() ? 92 : 130;
  const int text_width =
      1 + static_cast<int>(
              std::max(TextWidth(matrix.title, kTitleSize, /*bold=*/true),
                       TextWidth(matrix.subtitle, kTextSize)));
  GnuplotScript script(
      static_cast<int>(std::ceil(margins.left + margins.right)) +
          std::max({kMinWidth, classes * kCellWidth,
                    std::min(text_width, kMaxTextWidth)}),
      static_cast<int>(margins.bottom) + heading_height +
          classes * kCellHeight);
  const Box area = AddHeading(
      {.title = matrix.title, .subtitle = matrix.subtitle}, script, margins);
  const double cell_width = area.width() / classes;
  const double cell_height = area.height() / classes;
  std::vector<std::string> columns;
  std::vector<std::string> rows;
  for (int i = 0; i < classes; ++i) {
    const std::string column =
        GnuplotText(Shortened(matrix.labels[i], cell_width - 12, kTextSize));
    const std::string row =
        GnuplotText(Shortened(matrix.labels[i], kMaxLabelWidth, kTextSize));
    columns.push_back(absl::StrFormat("%s %.1f", column, i + 0.5));
    rows.push_back(absl::StrFormat("%s %.1f", row, i + 0.5));
    const std::vector<int>& counts = matrix.counts[i];
    const int total = std::accumulate(counts.begin(), counts.end(), 0);
    for (int j = 0; j < classes; ++j) {
      const double fraction =
          total == 0 ? 0 : static_cast<double>(counts[j]) / total;
      const char* ink = fraction > kDarkFrom ? "#ffffff" : kInk;
      script.Add(
          "set object rectangle from first %d,%d to first %d,%d back "
          "fc rgb '%s' fs solid 1 border lc rgb '%s' lw 2",
          j, i, j + 1, i + 1, CellColour(fraction), "#d8d8d8");
      const Point middle = {area.left + (j + 0.5) * cell_width,
                            area.top + (i + 0.5) * cell_height};
      script.Text(absl::StrCat(counts[j]), {middle.x, middle.y - 16},
                  {.size = 28, .colour = ink, .align = Align::kCentre});
      script.Text(absl::StrFormat("%.1f %%", 100 * fraction),
                  {middle.x, middle.y + 20},
                  {.size = kSmallSize, .colour = ink, .align = Align::kCentre});
    }
  }
  script.PlotArea(area);
  script.Add("unset grid");
  script.Add("set border 15 lc rgb '%s' lw 2.5", kSoftInk);
  script.Add("set tics scale 0");
  script.Add("set xrange [0:%d]", classes);
  script.Add("set yrange [%d:0]", classes);
  script.Add("set xtics (%s)", absl::StrJoin(columns, ", "));
  script.Add("set ytics (%s)", absl::StrJoin(rows, ", "));
  script.Add("set xlabel 'answer'");
  script.Add("set ylabel 'true class' offset -0.8,0");
  script.Add("plot NaN");
  return script;
}

}  // namespace tactus::internal::client
