#include "tools/trainctl/report/reproduce_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/figures/figure.h"

namespace tactus::internal::client {
namespace {

// Columns of a matrix in text.
constexpr int kNameWidth = 6;
constexpr int kCountWidth = 5;

const char* TitleOf(Experiment experiment) {
  return experiment == Experiment::kSimulation ? "Simulation" : "Virtual Cody";
}

std::string RowName(const ReproducedRow& row) {
  return absl::StrCat(PaperName(row.paper.algorithm), " ", row.paper.features);
}

// Lines of one matrix, all of one width.
std::vector<std::string> MatrixLines(const ReproducedRow& row) {
  const int width =
      kNameWidth + kCountWidth * static_cast<int>(row.class_names.size());
  std::vector<std::string> lines = {
      absl::StrFormat("%-*s", width, RowName(row)),
      absl::StrFormat("%*s", kNameWidth, "")};
  for (const std::string& name : row.class_names) {
    absl::StrAppendFormat(&lines[1], "%*.*s", kCountWidth, kCountWidth - 1,
                          name);
  }
  for (size_t i = 0; i < row.class_names.size(); ++i) {
    std::string line =
        absl::StrFormat("%*.*s", kNameWidth, kNameWidth, row.class_names[i]);
    for (int count : row.confusion[i]) {
      absl::StrAppendFormat(&line, "%*d", kCountWidth, count);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string SideBySide(const std::vector<std::vector<std::string>>& blocks) {
  size_t height = 0;
  for (const auto& block : blocks) height = std::max(height, block.size());
  std::string text;
  for (size_t i = 0; i < height; ++i) {
    std::string line;
    for (const auto& block : blocks) {
      if (!line.empty()) line += "  ";
      line +=
          i < block.size() ? block[i] : std::string(block.front().size(), ' ');
    }
    absl::StrAppend(&text, absl::StripTrailingAsciiWhitespace(line), "\n");
  }
  return text;
}

// "simulation-confusion-1nn-f-m-a.png".
std::string ConfusionFile(const ReproducedRow& row) {
  const std::string algorithm = absl::AsciiStrToLower(
      absl::StrReplaceAll(PaperName(row.paper.algorithm), {{"-", ""}}));
  const std::string features =
      absl::StrReplaceAll(row.paper.features, {{"+", "-"}});
  return absl::StrCat(SourceOf(row.experiment).name, "-confusion-", algorithm,
                      "-", features, ".png");
}

Bar BarOf(double percent, int trials) {
  const Interval interval = WilsonInterval(
      static_cast<int>(std::lround(percent / 100 * trials)), trials);
  return {percent, 100 * interval.low, 100 * interval.high};
}

}  // namespace

BarChart AccuracyChart(const std::vector<ReproducedRow>& rows) {
  const Experiment experiment = rows.front().experiment;
  const PaperSource source = SourceOf(experiment);
  BarChart chart;
  chart.title = absl::StrCat(TitleOf(experiment),
                             ": accuracy on the robot condition left out");
  chart.subtitle = "f force, m motion, a area; black bars are 95 % intervals";
  chart.y = {.title = "accuracy (%)", .low = 0, .high = 100};
  chart.x_title = "features";
  chart.series = {"here", "paper"};
  chart.references = {
      {.name = "majority class (paper)", .y = source.majority_percent}};
  for (const ReproducedRow& row : rows) {
    const std::string algorithm(PaperName(row.paper.algorithm));
    if (chart.sections.empty() || chart.sections.back().name != algorithm) {
      chart.sections.push_back({.name = algorithm});
    }
    std::optional<Bar> ours;
    if (row.ours_percent) {
      ours = BarOf(*row.ours_percent, row.trials - row.never_felt);
    }
    chart.sections.back().groups.push_back(
        {std::string(row.paper.features),
         {ours, BarOf(row.paper.accuracy_percent, source.trials)}});
  }
  return chart;
}

ConfusionMatrix ConfusionFigure(const ReproducedRow& row) {
  int right = 0;
  int count = 0;
  for (size_t i = 0; i < row.confusion.size(); ++i) {
    right += row.confusion[i][i];
    count +=
        std::accumulate(row.confusion[i].begin(), row.confusion[i].end(), 0);
  }
  const Interval interval = WilsonInterval(right, count);
  return {.title = absl::StrCat(TitleOf(row.experiment), ": ", RowName(row)),
          .subtitle = absl::StrFormat(
              "%d of %d right: %.1f %% (95 %%: %.1f to %.1f)", right, count,
              count == 0 ? 0 : 100. * right / count, 100 * interval.low,
              100 * interval.high),
          .labels = row.class_names,
          .counts = row.confusion};
}

std::optional<double> ReproducedRow::Difference() const {
  if (!ours_percent) return std::nullopt;
  return *ours_percent - paper.accuracy_percent;
}

int ReproducedRow::felt() const {
  int sum = 0;
  for (const auto& row : confusion) {
    sum = std::accumulate(row.begin(), row.end(), sum);
  }
  return sum;
}

int ReproducedRow::right() const {
  int sum = 0;
  for (size_t i = 0; i < confusion.size(); ++i) sum += confusion[i][i];
  return sum;
}

std::string TableHeading(Experiment experiment) {
  const PaperSource source = SourceOf(experiment);
  return absl::StrFormat(
      "%s: %d trials of %g s, leave-one-condition-out, paper's %s\n"
      "%-9s %-8s %8s %16s %8s %11s %9s\n",
      TitleOf(experiment), source.trials, source.seconds, source.table,
      "algorithm", "features", "ours, %", "95 % interval", "paper, %",
      "difference", "seconds");
}

std::string TableLine(const ReproducedRow& row) {
  const std::string ours =
      row.ours_percent ? absl::StrFormat("%.2f", *row.ours_percent) : "-";
  const std::string difference =
      row.ours_percent ? absl::StrFormat("%+.2f", *row.Difference()) : "-";
  const Interval interval = WilsonInterval(row.right(), row.felt());
  const std::string between =
      row.ours_percent ? absl::StrFormat("%.2f to %.2f", 100 * interval.low,
                                         100 * interval.high)
                       : "-";
  std::string line = absl::StrFormat(
      "%-9s %-8s %8s %16s %8.2f %11s %9.1f", PaperName(row.paper.algorithm),
      row.paper.features, ours, between, row.paper.accuracy_percent, difference,
      row.seconds);
  if (!row.ours_percent) absl::StrAppend(&line, "  ", row.reason);
  return line + "\n";
}

std::string ConfusionBlocks(const std::vector<ReproducedRow>& rows) {
  std::string text;
  std::vector<absl::string_view> done;
  for (const ReproducedRow& first : rows) {
    const absl::string_view features = first.paper.features;
    if (std::find(done.begin(), done.end(), features) != done.end()) continue;
    done.push_back(features);
    std::vector<std::vector<std::string>> blocks;
    for (const ReproducedRow& row : rows) {
      if (row.paper.features == features && !row.confusion.empty()) {
        blocks.push_back(MatrixLines(row));
      }
    }
    if (!blocks.empty()) absl::StrAppend(&text, "\n", SideBySide(blocks));
  }
  if (text.empty()) return text;
  return absl::StrCat("\nRows are labels, columns answers:\n", text);
}

Json RowToJson(const ReproducedRow& row) {
  Json json = {{"experiment", std::string(SourceOf(row.experiment).name)},
               {"algorithm", std::string(PaperName(row.paper.algorithm))},
               {"features", std::string(row.paper.features)},
               {"ours", nullptr},
               {"paper", row.paper.accuracy_percent},
               {"difference", nullptr},
               {"trials", row.trials},
               {"undetectable", row.never_felt},
               {"felt", row.felt()},
               {"right", row.right()},
               {"ours_interval", nullptr},
               {"classes", row.class_names},
               {"confusion", row.confusion},
               {"seconds", row.seconds}};
  if (row.ours_percent) {
    const Interval interval = WilsonInterval(row.right(), row.felt());
    json["ours"] = *row.ours_percent;
    json["ours_interval"] = {100 * interval.low, 100 * interval.high};
    json["difference"] = *row.Difference();
  } else {
    json["reason"] = row.reason;
  }
  return json;
}

absl::Status WriteFigures(const std::vector<ReproducedRow>& rows,
                          const std::string& folder) {
  const std::filesystem::path base(folder);
  const std::string name(SourceOf(rows.front().experiment).name);
  TACTUS_RETURN_IF_ERROR(DrawFigure(
      AccuracyChart(rows), (base / (name + "-accuracy.png")).string()));
  for (const ReproducedRow& row : rows) {
    if (row.confusion.empty()) continue;
    TACTUS_RETURN_IF_ERROR(
        DrawFigure(ConfusionFigure(row), (base / ConfusionFile(row)).string()));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
