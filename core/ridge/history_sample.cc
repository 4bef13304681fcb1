#include "core/ridge/history_sample.h"

#include <algorithm>
#include <cmath>

#include "core/base/limits.h"

namespace tactus::internal {

size_t EndOf(double part, size_t frames) {
  return std::max<size_t>(
      1, static_cast<size_t>(std::lround(part * static_cast<double>(frames))));
}

namespace {

std::vector<float> FitAuxiliary(std::span<const HistorySample> samples,
                                const TaxelShape& shape) {
  const auto first = static_cast<uint32_t>(shape.total() - shape.auxiliary);
  std::vector<double> squares(shape.auxiliary);
  std::vector<double> count(shape.auxiliary);
  for (const HistorySample& sample : samples) {
    for (const auto loads : sample.frames) {
      for (const TaxelLoad& load : loads) {
        const uint32_t component = load.taxel - first;
        if (load.taxel < first || component >= squares.size()) continue;
        const double value = static_cast<double>(load.root) * load.root;
        squares[component] += value * value;
        count[component] += 1;
      }
    }
  }
  std::vector<float> scale(shape.auxiliary, 1.0F);
  for (size_t i = 0; i < scale.size(); ++i) {
    if (count[i] == 0) continue;
    scale[i] = static_cast<float>(
        std::min(1 / std::sqrt(squares[i] / count[i]), limits::kMaxSignal));
  }
  return scale;
}

}  // namespace

FrameViews FitViews(std::span<const HistorySample> samples,
                    const TaxelShape& shape) {
  FrameViews views;
  views.rows = shape.rows;
  views.columns = shape.columns;
  views.planes = shape.planes;
  views.auxiliary_scale = FitAuxiliary(samples, shape);
  views.block = HistoryBlock(shape);
  double raw = 0;
  double root = 0;
  double shares = 0;
  double count = 0;
  for (const HistorySample& sample : samples) {
    for (const auto all : sample.frames) {
      const auto loads = WithoutComponents(all, shape.taxels());
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
      shares += 1;
      count += static_cast<double>(loads.size());
    }
  }
  if (count == 0) return views;
  const double sums[kFrameViews] = {raw, root, shares};
  for (int view = 0; view < kFrameViews; ++view) {
    views.scale[view] = static_cast<float>(1 / std::sqrt(sums[view] / count));
  }
  return views;
}

}  // namespace tactus::internal
