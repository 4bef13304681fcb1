#include "tools/trainctl/sparkline.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tactus::internal::client {
namespace {

constexpr const char* kBlocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr int kBlockCount = 8;

}  // namespace

std::string Sparkline(std::span<const double> values, size_t width) {
  std::vector<double> finite;
  for (const double value : values) {
    if (std::isfinite(value)) finite.push_back(value);
  }
  if (finite.empty() || width == 0) return "";
  const size_t columns = std::min(width, finite.size());
  std::vector<double> means(columns);
  for (size_t c = 0; c < columns; ++c) {
    const size_t begin = c * finite.size() / columns;
    const size_t end = (c + 1) * finite.size() / columns;
    for (size_t i = begin; i < end; ++i) {
      means[c] += finite[i] / static_cast<double>(end - begin);
    }
  }
  const auto [low, high] = std::minmax_element(means.begin(), means.end());
  std::string line;
  for (const double mean : means) {
    const double height = *high > *low ? (mean - *low) / (*high - *low) : 0;
    line += kBlocks[std::min(kBlockCount - 1,
                             static_cast<int>(height * kBlockCount))];
  }
  return line;
}

}  // namespace tactus::internal::client
