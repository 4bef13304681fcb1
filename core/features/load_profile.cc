#include "core/features/load_profile.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

void FillBands(std::span<const double> loads, std::span<double> bands) {
  const size_t count = std::min(loads.size(), bands.size());
  size_t line = 0;
  for (size_t band = 0; band < count; ++band) {
    const size_t end = (band + 1) * loads.size() / count;
    double sum = 0;
    for (; line < end; ++line) sum += loads[line];
    bands[band] = std::sqrt(sum);
  }
}

}  // namespace

LoadProfile MakeLoadProfile(std::span<const double> row_loads,
                            std::span<const double> column_loads) {
  LoadProfile profile = {};
  const std::span<double> bands(profile);
  FillBands(row_loads, bands.first(kRowBands));
  FillBands(column_loads, bands.last(kColumnBands));
  return profile;
}

}  // namespace tactus::internal
