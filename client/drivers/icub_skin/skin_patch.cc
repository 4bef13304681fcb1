#include "client/drivers/icub_skin/skin_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "Eigen/Core"
#include "Eigen/Eigenvalues"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/drivers/icub_skin/unroll.h"
#include "client/drivers/one_axis.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/skin/taxel_grid.h"

namespace tactus::internal::client::icub {
namespace {

constexpr absl::string_view kForearmV1 = "13,12:0-3+6+8-9";
// Triangles 0-17, 19, 22, 24, 25, 28 and 29 of the arm
// (icub-main, skinGui/left_forearm_V2.ini).
constexpr absl::string_view kForearmV2 = "13,12:0-1+3+6+8-9+12-13";

absl::Status BadBoards(absl::string_view got) {
  return InvalidConfig(
      "boards", got,
      "forearm-v1, forearm-v2, or addresses 1 to 14, each once, with their "
      "triangles 0 to 15, as in 13,12:0-1+3");
}

// "0-1+3" as bits.
bool ParseTriangles(absl::string_view text, uint16_t& triangles) {
  triangles = 0;
  for (const absl::string_view range : absl::StrSplit(text, '+')) {
    const std::pair<absl::string_view, absl::string_view> ends =
        absl::StrSplit(range, absl::MaxSplits('-', 1));
    int first = 0;
    if (!absl::SimpleAtoi(ends.first, &first)) return false;
    int last = first;
    const bool is_range = range.find('-') != absl::string_view::npos;
    if (is_range && !absl::SimpleAtoi(ends.second, &last)) return false;
    if (first < 0 || last < first || last >= kTriangles) return false;
    for (int t = first; t <= last; ++t) {
      triangles |= static_cast<uint16_t>(1U << t);
    }
  }
  return true;
}

// Thresholds and area of the preset, which were measured on this skin.
SkinLayout IcubLayout(std::string name) {
  SkinLayout layout = *LayoutPreset("icub-6x10");
  layout.name = std::move(name);
  layout.mask.clear();
  return layout;
}

bool IsThermal(int dot) { return (kThermalDots >> dot & 1) != 0; }

// The places of `points` on a grid whose pitch is the usual distance of
// neighbours; points that are closer may share a cell. Columns run along the
// longest way through the points.
TaxelGrid RoundToGrid(const std::vector<Eigen::Vector3d>& points) {
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd all(count, 3);
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d& point = points[static_cast<size_t>(i)];
    all.row(i) = point;
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& other : points) {
      const double distance = (point - other).norm();
      if (distance > 0) least = std::min(least, distance);
    }
    nearest.push_back(least);
  }
  const auto middle =
      nearest.begin() + static_cast<ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  const Eigen::RowVector3d mean = all.colwise().mean();
  all.rowwise() -= mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(all.transpose() *
                                                              all);
  // Rising: the longest way is the last.
  const Eigen::MatrixXd x = all * solver.eigenvectors().col(2);
  const Eigen::MatrixXd y = all * solver.eigenvectors().col(1);
  const double width = x.maxCoeff() - x.minCoeff();
  const double height = y.maxCoeff() - y.minCoeff();
  // No finer than the largest grid allows.
  const double pitch =
      std::max({*middle, width / (limits::kMaxColumns - 1),
                height / (limits::kMaxRows - 1), limits::kMinTaxelPitchM});
  TaxelGrid grid;
  grid.columns = static_cast<int>(std::lround(width / pitch)) + 1;
  grid.rows = static_cast<int>(std::lround(height / pitch)) + 1;
  grid.row_pitch_m = grid.column_pitch_m = pitch;
  grid.mask.assign(static_cast<size_t>(grid.rows) * grid.columns, 0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto column =
        static_cast<int>(std::lround((x(i) - x.minCoeff()) / pitch));
    const auto row =
        static_cast<int>(std::lround((y(i) - y.minCoeff()) / pitch));
    grid.cells.push_back(row * grid.columns + column);
    grid.mask[static_cast<size_t>(grid.cells.back())] = 1;
  }
  return grid;
}

bool HasTriangle(const SkinBoard& board, int triangle) {
  return (board.triangles >> triangle & 1) != 0;
}

}  // namespace

absl::StatusOr<std::vector<SkinBoard>> ParseBoards(absl::string_view text) {
  if (text == "forearm-v1") text = kForearmV1;
  if (text == "forearm-v2") text = kForearmV2;
  std::vector<SkinBoard> boards;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    const std::pair<absl::string_view, absl::string_view> sides =
        absl::StrSplit(part, absl::MaxSplits(':', 1));
    SkinBoard board;
    if (!absl::SimpleAtoi(sides.first, &board.address) ||
        board.address < kFirstBoard || board.address > kLastBoard) {
      return BadBoards(text);
    }
    if (part.find(':') != absl::string_view::npos &&
        !ParseTriangles(sides.second, board.triangles)) {
      return BadBoards(text);
    }
    for (const SkinBoard& other : boards) {
      if (other.address == board.address) return BadBoards(text);
    }
    boards.push_back(board);
  }
  return boards;
}

absl::StatusOr<SkinPatch> PortPatch(const std::vector<SkinBoard>& boards) {
  SkinPatch patch;
  patch.boards = boards;
  patch.layout =
      IcubLayout(absl::StrCat("icub-port-", boards.size() * kBoardValues));
  patch.layout.rows = static_cast<int>(boards.size()) * kTriangles;
  patch.layout.columns = kDots;
  for (const SkinBoard& board : boards) {
    for (int t = 0; t < kTriangles; ++t) {
      for (int k = 0; k < kDots; ++k) {
        const int value = static_cast<int>(patch.cells.size());
        const bool taxel = HasTriangle(board, t) && !IsThermal(k);
        patch.cells.push_back(taxel ? value : -1);
        patch.layout.mask.push_back(taxel ? 1 : 0);
      }
    }
  }
  TACTUS_RETURN_IF_ERROR(Validate(patch));
  return patch;
}

absl::StatusOr<SkinPatch> PlacedPatch(const std::vector<SkinBoard>& boards,
                                      const TaxelPositions& positions,
                                      uint16_t thermal_dots) {
  const size_t values = boards.size() * kBoardValues;
  if (positions.values.size() != values) {
    return InvalidConfig("rows of the position file", positions.values.size(),
                         absl::StrCat(values, ", 192 for each board"));
  }
  // Each place once, with the values that lie there.
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::vector<size_t>> owners;
  std::map<std::array<double, 3>, size_t> places;
  for (size_t i = 0; i < values; ++i) {
    const TaxelPosition& taxel = positions.values[i];
    const int t = static_cast<int>(i % kBoardValues) / kDots;
    const bool named_none = i < positions.representatives.size() &&
                            positions.representatives[i] < 0;
    if (!taxel.present || named_none || (thermal_dots >> i % kDots & 1) != 0 ||
        !HasTriangle(boards[i / kBoardValues], t)) {
      continue;
    }
    const auto [place, is_new] = places.emplace(
        std::array{taxel.position.x(), taxel.position.y(), taxel.position.z()},
        points.size());
    if (is_new) {
      points.push_back(taxel.position);
      normals.push_back(taxel.normal);
      owners.emplace_back();
    }
    owners[place->second].push_back(i);
  }
  if (points.size() < 2) {
    return InvalidConfig("taxels with a place", points.size(), "at least 2");
  }
  const std::vector<Eigen::Vector3d> flat = Unroll(points, normals);
  const auto exact = PlaceOnGrid(flat);
  // A cell for each place, if that is possible.
  const TaxelGrid grid = exact.ok() ? *exact : RoundToGrid(flat);
  SkinPatch patch;
  patch.boards = boards;
  patch.cells.assign(values, -1);
  patch.layout =
      IcubLayout(positions.name.empty() ? "icub-skin" : positions.name);
  patch.layout.rows = grid.rows;
  patch.layout.columns = grid.columns;
  patch.layout.row_pitch_m = grid.row_pitch_m;
  patch.layout.column_pitch_m = grid.column_pitch_m;
  patch.layout.mask = grid.mask;
  for (size_t p = 0; p < owners.size(); ++p) {
    for (const size_t value : owners[p]) patch.cells[value] = grid.cells[p];
  }
  TACTUS_RETURN_IF_ERROR(Validate(patch));
  return patch;
}

std::vector<std::optional<Eigen::Vector3d>> CellPositions(
    const SkinPatch& patch, const TaxelPositions& positions) {
  const auto cells = static_cast<size_t>(patch.layout.taxels());
  std::vector<std::optional<Eigen::Vector3d>> places(cells);
  std::vector<double> counts(cells, 0);
  const size_t values = std::min(patch.cells.size(), positions.values.size());
  for (size_t i = 0; i < values; ++i) {
    if (patch.cells[i] < 0 || !positions.values[i].present) continue;
    const auto cell = static_cast<size_t>(patch.cells[i]);
    places[cell] = places[cell].value_or(Eigen::Vector3d::Zero()) +
                   positions.values[i].position;
    ++counts[cell];
  }
  for (size_t cell = 0; cell < cells; ++cell) {
    if (places[cell]) *places[cell] /= counts[cell];
  }
  return places;
}

absl::Status Validate(const SkinPatch& patch) {
  TACTUS_RETURN_IF_ERROR(tactus::internal::Validate(patch.layout));
  TACTUS_RETURN_IF_ERROR(CheckOneAxis("an iCub's skin", patch.layout));
  if (patch.boards.empty()) {
    return InvalidConfig("boards", "none", "at least one");
  }
  const size_t values = patch.boards.size() * kBoardValues;
  if (patch.cells.size() != values) {
    return InvalidConfig("cells of the patch", patch.cells.size(),
                         absl::StrCat(values, ", one for each value"));
  }
  for (const int cell : patch.cells) {
    if (cell < -1 || cell >= patch.layout.taxels()) {
      return InvalidConfig("cell of the patch", cell,
                           "a cell of the layout, or -1");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::icub
