#include "tools/trainctl/skin/gain_file.h"

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/files/csv.h"
#include "tools/trainctl/skin/taxel_cell.h"

namespace tactus::internal::client {

absl::StatusOr<std::vector<std::optional<GainCurve>>> ReadGains(
    const std::string& path, int taxels) {
  TACTUS_ASSIGN_OR_RETURN(const CsvTable table, CsvTable::Read(path));
  TACTUS_ASSIGN_OR_RETURN(const size_t taxel_column, table.Column("taxel"));
  TACTUS_ASSIGN_OR_RETURN(const size_t reading_column, table.Column("reading"));
  TACTUS_ASSIGN_OR_RETURN(const size_t load_column, table.Column("load"));
  std::map<int, std::vector<GainPoint>> points;
  for (size_t row = 0; row < table.rows(); ++row) {
    TACTUS_ASSIGN_OR_RETURN(const int taxel,
                            TaxelCell(table, row, taxel_column, taxels));
    GainPoint point;
    TACTUS_ASSIGN_OR_RETURN(point.reading, table.Number(row, reading_column));
    TACTUS_ASSIGN_OR_RETURN(point.load, table.Number(row, load_column));
    points[taxel].push_back(point);
  }
  std::vector<std::optional<GainCurve>> gains(taxels);
  for (auto& [taxel, list] : points) {
    auto curve = GainCurve::Make(std::move(list));
    if (!curve.ok()) {
      const std::string name = taxel == kEachTaxel ? "*" : absl::StrCat(taxel);
      return Annotate(curve.status(), absl::StrCat(path, ": taxel ", name));
    }
    if (taxel == kEachTaxel) {
      // The first of the map, so that other curves replace it.
      gains.assign(taxels, *curve);
    } else {
      gains[taxel] = *std::move(curve);
    }
  }
  return gains;
}

}  // namespace tactus::internal::client
