#include "core/import/rising_columns.h"

#include <algorithm>

#include "core/import/frame_columns.h"

namespace tactus {
namespace {

// Fewer frames may rise by chance.
constexpr size_t kLeastRisingFrames = 8;
// Of the mean step.
constexpr double kLeastStep = 0.5;
constexpr double kMostStep = 2;

}  // namespace

std::vector<RisingColumn> FindRising(const ArrayFile& file,
                                     const std::vector<size_t>& columns) {
  std::vector<RisingColumn> found;
  const size_t frames = file.array.shape[0];
  if (frames < kLeastRisingFrames) return found;
  const size_t width = file.size() / frames;
  for (const size_t column : columns) {
    const auto at = [&](size_t frame) {
      return file.Number(frame * width + column);
    };
    double least = at(1) - at(0);
    double most = least;
    for (size_t t = 2; t < frames && least > 0; ++t) {
      const double step = at(t) - at(t - 1);
      least = std::min(least, step);
      most = std::max(most, step);
    }
    if (!(least > 0)) continue;
    const double mean =
        (at(frames - 1) - at(0)) / static_cast<double>(frames - 1);
    found.push_back(
        {.column = column,
         .name = ColumnName(file, column),
         .steady = least >= kLeastStep * mean && most <= kMostStep * mean});
  }
  return found;
}

void RisingColumns::Add(const std::vector<RisingColumn>& rising,
                        size_t frames) {
  if (frames < kLeastRisingFrames) return;
  ++files_;
  for (const RisingColumn& column : rising) {
    Seen& seen = seen_[column.name];
    const bool steady =
        column.steady && (seen.files == 0 || seen.column.steady);
    seen.column = column;
    seen.column.steady = steady;
    ++seen.files;
  }
}

std::vector<RisingColumn> RisingColumns::Always() const {
  std::vector<RisingColumn> always;
  for (const auto& [name, seen] : seen_) {
    if (seen.files == files_) always.push_back(seen.column);
  }
  return always;
}

}  // namespace tactus
