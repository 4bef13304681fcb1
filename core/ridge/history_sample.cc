#include "core/ridge/history_sample.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {

size_t EndOf(double part, size_t frames) {
  return std::max<size_t>(
      1, static_cast<size_t>(std::lround(part * static_cast<double>(frames))));
}

FrameViews FitViews(std::span<const HistorySample> samples, int rows,
                    int columns) {
  FrameViews views;
  views.rows = rows;
  views.columns = columns;
  views.block = HistoryBlock(rows, columns);
  double raw = 0;
  double root = 0;
  double shape = 0;
  double count = 0;
  for (const HistorySample& sample : samples) {
    for (const auto loads : sample.frames) {
      double whole = 0;
      double squares = 0;
      for (const TaxelLoad& load : loads) {
        const double value = static_cast<double>(load.root) * load.root;
        whole += value;
        squares += value * value;
      }
      if (whole <= 0) continue;
      raw += squares;
      root += whole;
      shape += 1;
      count += static_cast<double>(loads.size());
    }
  }
  if (count == 0) return views;
  const double sums[kFrameViews] = {raw, root, shape};
  for (int view = 0; view < kFrameViews; ++view) {
    views.scale[view] = static_cast<float>(1 / std::sqrt(sums[view] / count));
  }
  return views;
}

}  // namespace tactus::internal
