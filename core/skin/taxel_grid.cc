#include "core/skin/taxel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "Eigen/Eigenvalues"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr char kField[] = "taxel_positions";
// Neighbours are closer than this many times the usual nearest distance.
constexpr double kNeighbourReach = 1.3;
// Pitches that are tried, as multiples of the usual nearest distance.
constexpr double kSmallestPitch = 0.5;
constexpr double kPitchStep = 0.05;
constexpr int kPitches = 15;

using Points = std::vector<Eigen::Vector2d>;

// In the x-y plane as they are; else along their principal axes.
Points Flatten(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& position : positions) mean += position;
  mean /= static_cast<double>(positions.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& position : positions) {
    spread += (position - mean) * (position - mean).transpose();
  }
  Eigen::Matrix<double, 3, 2> axes;
  axes << 1, 0, 0, 1, 0, 0;
  if (spread(2, 2) > 1e-12 * spread.trace()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    axes << solver.eigenvectors().col(2), solver.eigenvectors().col(1);
    // The same points give the same axes whatever the solver's signs.
    for (int i = 0; i < 2; ++i) {
      Eigen::Index largest = 0;
      axes.col(i).cwiseAbs().maxCoeff(&largest);
      if (axes(largest, i) < 0) axes.col(i) *= -1;
    }
  }
  Points points;
  for (const auto& position : positions) {
    points.emplace_back(axes.transpose() * (position - mean));
  }
  return points;
}

// The median over taxels of the distance to the nearest other one.
absl::StatusOr<double> UsualDistance(const Points& points) {
  std::vector<double> nearest;
  for (size_t i = 0; i < points.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < points.size(); ++k) {
      if (k != i) least = std::min(least, (points[i] - points[k]).norm());
    }
    if (least < limits::kMinTaxelPitchM) {
      return InvalidConfig(kField,
                           absl::StrCat("taxel ", i, " where another one is"),
                           "one place per taxel");
    }
    nearest.push_back(least);
  }
  const auto middle =
      nearest.begin() + static_cast<ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

std::vector<std::pair<int, int>> Neighbours(const Points& points,
                                            double distance) {
  std::vector<std::pair<int, int>> pairs;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t k = i + 1; k < points.size(); ++k) {
      if ((points[i] - points[k]).norm() < kNeighbourReach * distance) {
        pairs.emplace_back(i, k);
      }
    }
  }
  return pairs;
}

// The pitches that are tried along an axis: multiples of the usual distance,
// and the usual gap between coordinates, which is exact for a regular skin.
std::vector<double> Pitches(const Points& points, int axis, double distance) {
  std::vector<double> pitches;
  for (int i = kPitches - 1; i >= 0; --i) {
    pitches.push_back(distance * (kSmallestPitch + kPitchStep * i));
  }
  std::vector<double> at;
  for (const auto& point : points) at.push_back(point[axis]);
  std::sort(at.begin(), at.end());
  std::vector<double> gaps;
  for (size_t i = 1; i < at.size(); ++i) {
    // Less is the scatter of one row.
    if (at[i] - at[i - 1] > 0.2 * distance) gaps.push_back(at[i] - at[i - 1]);
  }
  if (gaps.empty()) return pitches;
  const auto middle = gaps.begin() + static_cast<ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  pitches.push_back(*middle);
  return pitches;
}

// The grid of these pitches; no rows if taxels share a cell or it is too large.
TaxelGrid Place(const Points& points, double column_pitch, double row_pitch) {
  Eigen::Vector2d low = points.front();
  for (const auto& point : points) low = low.cwiseMin(point);
  TaxelGrid grid;
  std::vector<std::pair<int, int>> places;
  for (const auto& point : points) {
    // A place halfway between two cells takes the same side everywhere.
    const auto cell = [](double at) {
      return static_cast<int>(std::floor(at + 0.5 + 1e-9));
    };
    const int row = cell((point.y() - low.y()) / row_pitch);
    const int column = cell((point.x() - low.x()) / column_pitch);
    if (row >= limits::kMaxRows || column >= limits::kMaxColumns) return {};
    grid.rows = std::max(grid.rows, row + 1);
    grid.columns = std::max(grid.columns, column + 1);
    places.emplace_back(row, column);
  }
  grid.row_pitch_m = row_pitch;
  grid.column_pitch_m = column_pitch;
  grid.mask.assign(grid.rows * grid.columns, 0);
  for (const auto& [row, column] : places) {
    const int cell = row * grid.columns + column;
    if (grid.mask[cell] != 0) return {};
    grid.mask[cell] = 1;
    grid.cells.push_back(cell);
  }
  return grid;
}

// The distance between neighbouring cells that fits the places of the taxels in
// them best: the slope of a line. `pitch` if all taxels are in one row.
double FittedPitch(const Points& points, int axis,
                   const std::vector<int>& index, double pitch) {
  double mean_index = 0;
  double mean_place = 0;
  const auto count = static_cast<double>(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    mean_index += index[i] / count;
    mean_place += points[i][axis] / count;
  }
  double product = 0;
  double square = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    product += (index[i] - mean_index) * (points[i][axis] - mean_place);
    square += (index[i] - mean_index) * (index[i] - mean_index);
  }
  return square > 0 ? product / square : pitch;
}

void FitPitches(const Points& points, TaxelGrid& grid) {
  std::vector<int> rows;
  std::vector<int> columns;
  for (const int cell : grid.cells) {
    rows.push_back(cell / grid.columns);
    columns.push_back(cell % grid.columns);
  }
  grid.row_pitch_m = FittedPitch(points, 1, rows, grid.row_pitch_m);
  grid.column_pitch_m = FittedPitch(points, 0, columns, grid.column_pitch_m);
}

int CountSeparated(const TaxelGrid& grid,
                   const std::vector<std::pair<int, int>>& neighbours) {
  int separated = 0;
  for (const auto& [a, b] : neighbours) {
    const auto from = std::div(grid.cells[a], grid.columns);
    const auto to = std::div(grid.cells[b], grid.columns);
    separated +=
        std::abs(from.quot - to.quot) > 1 || std::abs(from.rem - to.rem) > 1;
  }
  return separated;
}

}  // namespace

absl::StatusOr<TaxelGrid> PlaceOnGrid(
    const std::vector<Eigen::Vector3d>& positions) {
  if (positions.size() < 2 || positions.size() > limits::kMaxTaxels) {
    return InvalidConfig(kField, positions.size(),
                         absl::StrCat("2 to ", limits::kMaxTaxels, " taxels"));
  }
  const Points points = Flatten(positions);
  TACTUS_ASSIGN_OR_RETURN(const double distance, UsualDistance(points));
  const auto neighbours = Neighbours(points, distance);
  TaxelGrid best;
  for (const double row_pitch : Pitches(points, 1, distance)) {
    for (const double column_pitch : Pitches(points, 0, distance)) {
      TaxelGrid grid = Place(points, column_pitch, row_pitch);
      if (grid.rows == 0) continue;
      grid.neighbours = static_cast<int>(neighbours.size());
      grid.separated = CountSeparated(grid, neighbours);
      const auto rank = [](const TaxelGrid& g) {
        return std::pair(g.separated, g.rows * g.columns);
      };
      if (best.rows == 0 || rank(grid) < rank(best)) best = std::move(grid);
    }
  }
  if (best.rows == 0) {
    return InvalidConfig(
        kField, absl::StrCat(positions.size(), " taxels"),
        absl::StrCat("places on a grid of at most ", limits::kMaxRows, " x ",
                     limits::kMaxColumns));
  }
  FitPitches(points, best);
  if (std::count(best.mask.begin(), best.mask.end(), 0) == 0) {
    best.mask.clear();
  }
  return best;
}

}  // namespace tactus::internal
