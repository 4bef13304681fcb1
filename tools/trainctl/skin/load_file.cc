#include "tools/trainctl/skin/load_file.h"

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/files/csv.h"
#include "tools/trainctl/skin/taxel_cell.h"

namespace tactus::internal::client {
namespace {

// Columns of a vector: `name` and the axis.
absl::StatusOr<std::array<size_t, kMostAxes>> AxisColumns(
    const CsvTable& table, const std::string& name) {
  std::array<size_t, kMostAxes> columns;
  for (size_t axis = 0; axis < kMostAxes; ++axis) {
    TACTUS_ASSIGN_OR_RETURN(columns[axis],
                            table.Column(absl::StrCat(name, kAxisNames[axis])));
  }
  return columns;
}

absl::StatusOr<AxisVector> AxisCells(
    const CsvTable& table, size_t row,
    const std::array<size_t, kMostAxes>& columns) {
  AxisVector cells;
  for (size_t axis = 0; axis < kMostAxes; ++axis) {
    TACTUS_ASSIGN_OR_RETURN(cells[axis], table.Number(row, columns[axis]));
  }
  return cells;
}

}  // namespace

absl::Status CheckLoadFlags(const std::string& gains, const std::string& loads,
                            const SkinLayout& layout) {
  if (!gains.empty() && layout.axes > 1) {
    return InvalidConfig("--gains", "given for a skin of three axes",
                         "--loads, a file of known loads along all axes");
  }
  if (!loads.empty() && layout.axes == 1) {
    return InvalidConfig("--loads", "given for a skin of one axis",
                         "--gains, a file of readings and loads");
  }
  return absl::OkStatus();
}

absl::StatusOr<LoadFile> ReadLoads(const std::string& path, int taxels) {
  TACTUS_ASSIGN_OR_RETURN(const CsvTable table, CsvTable::Read(path));
  TACTUS_ASSIGN_OR_RETURN(const size_t taxel_column, table.Column("taxel"));
  TACTUS_ASSIGN_OR_RETURN(const auto reading_columns,
                          AxisColumns(table, "reading_"));
  TACTUS_ASSIGN_OR_RETURN(const auto load_columns, AxisColumns(table, "load_"));
  std::map<int, std::vector<KnownLoad>> known;
  for (size_t row = 0; row < table.rows(); ++row) {
    TACTUS_ASSIGN_OR_RETURN(const int taxel,
                            TaxelCell(table, row, taxel_column, taxels));
    KnownLoad line;
    TACTUS_ASSIGN_OR_RETURN(line.reading,
                            AxisCells(table, row, reading_columns));
    TACTUS_ASSIGN_OR_RETURN(line.load, AxisCells(table, row, load_columns));
    known[taxel].push_back(line);
  }
  if (known.empty()) {
    return Annotate(InvalidConfig("lines of known loads", 0, "3 or more"),
                    path);
  }
  LoadFile file;
  file.lines = table.rows();
  const bool one_for_all = known.size() == 1 && known.contains(kEachTaxel);
  file.cross_axis.resize(one_for_all ? 1 : taxels);
  for (const auto& [taxel, lines] : known) {
    const auto fit = FitCrossAxis(lines);
    if (!fit.ok()) {
      const std::string name = taxel == kEachTaxel ? "*" : absl::StrCat(taxel);
      return Annotate(fit.status(), absl::StrCat(path, ": taxel ", name));
    }
    for (size_t axis = 0; axis < kMostAxes; ++axis) {
      file.residual[axis] += fit->squares[axis];
    }
    if (taxel == kEachTaxel) {
      // The first of the map, so that other matrices replace it.
      file.cross_axis.assign(file.cross_axis.size(), fit->cross_axis);
    } else {
      file.cross_axis[taxel] = fit->cross_axis;
    }
  }
  for (double& residual : file.residual) {
    residual = std::sqrt(residual / static_cast<double>(file.lines));
  }
  return file;
}

}  // namespace tactus::internal::client
