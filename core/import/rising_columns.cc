#include "core/import/rising_columns.h"

#include <algorithm>
#include <limits>

#include "core/import/frame_columns.h"

namespace tactus::internal {
namespace {

// Fewer frames may rise by chance.
constexpr size_t kLeastRisingFrames = 8;
// A counter of 4 bits or more begins again after as many frames.
constexpr size_t kLeastFramesPerFall = 16;
// Least and largest step of a steady column, as fractions of the mean one.
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
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    double sum = 0;
    size_t falls = 0;
    double least_fall = std::numeric_limits<double>::infinity();
    double most_fall = 0;
    size_t frame = 1;
    for (; frame < frames && falls <= 1 + frame / kLeastFramesPerFall;
         ++frame) {
      const double step = at(frame) - at(frame - 1);
      if (step == 0) break;
      if (step < 0) {
        ++falls;
        least_fall = std::min(least_fall, -step);
        most_fall = std::max(most_fall, -step);
        continue;
      }
      least = std::min(least, step);
      most = std::max(most, step);
      sum += step;
    }
    if (frame < frames || falls * kLeastFramesPerFall > frames) continue;
    const double mean = sum / static_cast<double>(frames - 1 - falls);
    const bool steady = least >= kLeastStep * mean && most <= kMostStep * mean;
    // A load that rises evenly falls once, or from different heights.
    const bool counter =
        steady && falls > 1 && most_fall - least_fall <= kMostStep * mean;
    if (falls > 0 && !counter) continue;
    found.push_back(
        {.column = column, .name = ColumnName(file, column), .steady = steady});
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

}  // namespace tactus::internal
