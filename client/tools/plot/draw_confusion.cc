#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/plot/draw.h"
#include "client/tools/plot/frame.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr double kCellWidth = 68;
constexpr double kCellHeight = 54;
constexpr double kMargin = 14;
constexpr Colour kFull = {8, 69, 128};
constexpr TextStyle kLabelStyle = {.size = 12};

absl::Status Check(const ConfusionMatrix& matrix) {
  const size_t classes = matrix.labels.size();
  if (classes > kMaxMatrixClasses) {
    return InvalidConfig("classes of a confusion matrix", classes,
                         absl::StrCat("at most ", kMaxMatrixClasses));
  }
  bool square = classes > 0 && matrix.counts.size() == classes;
  bool counts = true;
  for (const auto& row : matrix.counts) {
    square = square && row.size() == classes;
    for (int count : row) counts = counts && count >= 0;
  }
  if (!square) {
    return InvalidConfig(
        "confusion matrix",
        absl::StrCat(matrix.counts.size(), " rows, ", classes, " labels"),
        "a row and a column for each of 1 or more labels");
  }
  if (!counts) {
    return InvalidConfig("confusion matrix", "a count below 0", "0 or more");
  }
  return absl::OkStatus();
}

std::string Summary(const ConfusionMatrix& matrix) {
  int right = 0;
  int all = 0;
  for (size_t i = 0; i < matrix.counts.size(); ++i) {
    right += matrix.counts[i][i];
    all =
        std::accumulate(matrix.counts[i].begin(), matrix.counts[i].end(), all);
  }
  if (all == 0) return "no trials";
  return absl::StrFormat("%.2f %% right, %d of %d trials", 100.0 * right / all,
                         right, all);
}

void DrawCell(const Box& cell, int count, int row_total, Canvas& canvas) {
  const double share =
      row_total == 0 ? 0 : static_cast<double>(count) / row_total;
  canvas.FillBox(cell, Mix(kWhite, kFull, share));
  const Colour ink = share > 0.45 ? kWhite : kInk;
  const double x = (cell.left + cell.right) / 2;
  const double y = (cell.top + cell.bottom) / 2;
  canvas.Text(
      absl::StrCat(count), {x, y - 8},
      {.size = 14, .colour = ink, .bold = true, .align = Align::kMiddle});
  const std::string percent =
      row_total == 0 ? "-" : absl::StrFormat("%.1f %%", 100 * share);
  canvas.Text(percent, {x, y + 11},
              {.size = 10, .colour = ink, .align = Align::kMiddle});
}

void DrawGridLines(const Box& grid, int classes, Canvas& canvas) {
  for (int i = 0; i <= classes; ++i) {
    const double x = grid.left + i * kCellWidth;
    const double y = grid.top + i * kCellHeight;
    const Colour& colour = i == 0 || i == classes ? kSoftInk : kGrid;
    canvas.Line({x, grid.top}, {x, grid.bottom}, colour, 0.8);
    canvas.Line({grid.left, y}, {grid.right, y}, colour, 0.8);
  }
}

}  // namespace

absl::StatusOr<Canvas> Draw(const ConfusionMatrix& matrix) {
  TACTUS_RETURN_IF_ERROR(Check(matrix));
  const int classes = static_cast<int>(matrix.labels.size());
  double label_width = 0;
  for (const std::string& label : matrix.labels) {
    label_width = std::max(label_width, Canvas::TextWidth(label, kLabelStyle));
  }
  const std::string summary = Summary(matrix);
  const TextStyle title_style = {.size = kTitleSize, .bold = true};
  const TextStyle summary_style = {.size = 11, .colour = kSoftInk};
  const double title_height = matrix.title.empty() ? 0 : kTitleSize + 9;
  Box grid;
  grid.left = kMargin + kAxisTitleSize + 12 + label_width + 8;
  grid.top = kMargin + title_height + summary_style.size + 12;
  grid.right = grid.left + classes * kCellWidth;
  grid.bottom = grid.top + classes * kCellHeight;
  const double width =
      kMargin +
      std::max({grid.right,
                grid.left + Canvas::TextWidth(matrix.title, title_style),
                grid.left + Canvas::TextWidth(summary, summary_style)});
  const double height = grid.bottom + kMargin + 2 * kAxisTitleSize + 18;

  Canvas canvas(width, height);
  canvas.Text(matrix.title, {grid.left, kMargin + kTitleSize / 2}, title_style);
  canvas.Text(summary,
              {grid.left, kMargin + title_height + summary_style.size / 2},
              summary_style);
  for (int i = 0; i < classes; ++i) {
    const auto& row = matrix.counts[i];
    const int total = std::accumulate(row.begin(), row.end(), 0);
    const double top = grid.top + i * kCellHeight;
    for (int j = 0; j < classes; ++j) {
      const double left = grid.left + j * kCellWidth;
      DrawCell({left, top, left + kCellWidth, top + kCellHeight}, row[j], total,
               canvas);
    }
    canvas.Text(matrix.labels[i], {grid.left - 8, top + kCellHeight / 2},
                {.size = kLabelStyle.size, .align = Align::kEnd});
    canvas.Text(matrix.labels[i],
                {grid.left + (i + 0.5) * kCellWidth,
                 grid.bottom + 8 + kLabelStyle.size / 2},
                {.size = kLabelStyle.size, .align = Align::kMiddle});
  }
  DrawGridLines(grid, classes, canvas);
  canvas.VerticalText(
      "true class",
      {kMargin + kAxisTitleSize / 2, (grid.top + grid.bottom) / 2},
      {.size = kAxisTitleSize});
  canvas.Text(
      "answer",
      {(grid.left + grid.right) / 2, height - kMargin - kAxisTitleSize / 2},
      {.size = kAxisTitleSize, .align = Align::kMiddle});
  return canvas;
}

}  // namespace tactus::client
