#include "client/kinematics/skin_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/errors.h"

namespace tactus::internal::client {

absl::StatusOr<SkinPlaces> SkinPlaces::FromPositions(
    const SkinLayout& layout,
    std::vector<std::optional<Eigen::Vector3d>> cells) {
  if (cells.size() != static_cast<size_t>(layout.taxels())) {
    return InvalidConfig("positions of cells", cells.size(),
                         absl::StrCat(layout.taxels(), ", one per cell"));
  }
  int known = 0;
  for (const auto& cell : cells) {
    if (!cell) continue;
    ++known;
    if (!cell->allFinite()) {
      return InvalidConfig("position of a cell", "not finite", "metres");
    }
  }
  if (known == 0) {
    return InvalidConfig("positions of cells", "none", "at least one");
  }
  SkinPlaces places(layout);
  places.cells_ = std::move(cells);
  return places;
}

Eigen::Vector3d SkinPlaces::OnLink(const SkinPoint& point) const {
  if (cells_.empty()) return LinkPosition(layout_, point);
  const double row = std::clamp(point.row, 0.0, layout_.rows - 1.0);
  const double column =
      layout_.wrap_columns
          ? point.column -
                layout_.columns * std::floor(point.column / layout_.columns)
          : std::clamp(point.column, 0.0, layout_.columns - 1.0);
  const int top = static_cast<int>(row);
  const int left = static_cast<int>(column);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (int i = 0; i < 4; ++i) {
    const int r = top + i / 2;
    int c = left + i % 2;
    const double weight = (1 - std::abs(row - r)) * (1 - std::abs(column - c));
    if (layout_.wrap_columns) c %= layout_.columns;
    if (weight <= 0 || r >= layout_.rows || c >= layout_.columns) continue;
    const auto& cell = cells_[static_cast<size_t>(r * layout_.columns + c)];
    if (!cell) continue;
    sum += weight * *cell;
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3d(sum / weights)
                     : NearestCell({row, column});
}

Eigen::Vector3d SkinPlaces::NearestCell(const SkinPoint& point) const {
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < cells_.size(); ++i) {
    if (!cells_[i]) continue;
    const auto cell = static_cast<int>(i);
    const double distance =
        SkinDistance(layout_,
                     {.row = static_cast<double>(cell / layout_.columns),
                      .column = static_cast<double>(cell % layout_.columns)},
                     point);
    if (distance >= least) continue;
    least = distance;
    nearest = *cells_[i];
  }
  return nearest;
}

}  // namespace tactus::internal::client
