#include "client/drivers/calibration/cross_axis.h"

#include <cmath>

#include "Eigen/SVD"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// A direction with less than this fraction of the largest singular value is
// noise.
constexpr double kLeastDirection = 1e-3;

// One row per known load, one column per axis. Eigen computes thin singular
// vectors only of matrices whose width is not fixed.
using AxisColumns = Eigen::MatrixXd;

absl::Status CheckAxisNumbers(absl::string_view name, const AxisVector& axes) {
  for (size_t axis = 0; axis < kMostAxes; ++axis) {
    // Written so that a NaN fails.
    if (!(std::abs(axes[axis]) <= limits::kMaxTaxelValue)) {
      return InvalidConfig(
          absl::StrCat(name, kAxisNames[axis]), axes[axis],
          absl::StrCat("finite, from -", limits::kMaxTaxelValue, " to ",
                       limits::kMaxTaxelValue));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckMatrices(const CrossAxes& matrices, size_t taxels) {
  if (matrices.size() > 1 && matrices.size() != taxels) {
    return InvalidConfig("matrices of cross_axis", matrices.size(),
                         absl::StrCat("none, 1 or ", taxels));
  }
  for (size_t i = 0; i < matrices.size(); ++i) {
    if (!matrices[i]) continue;
    for (size_t axis = 0; axis < kMostAxes; ++axis) {
      TACTUS_RETURN_IF_ERROR(CheckAxisNumbers(
          absl::StrCat("cross_axis of taxel ",
                       matrices.size() == 1 ? "*" : absl::StrCat(i), ", load_",
                       kAxisNames[axis], " per reading_"),
          matrices[i]->rows[axis]));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<CrossAxisFit> FitCrossAxis(std::span<const KnownLoad> known) {
  AxisColumns readings(known.size(), kMostAxes);
  AxisColumns loads(known.size(), kMostAxes);
  for (size_t i = 0; i < known.size(); ++i) {
    TACTUS_RETURN_IF_ERROR(CheckAxisNumbers("reading_", known[i].reading));
    TACTUS_RETURN_IF_ERROR(CheckAxisNumbers("load_", known[i].load));
    for (size_t axis = 0; axis < kMostAxes; ++axis) {
      readings(i, axis) = known[i].reading[axis];
      loads(i, axis) = known[i].load[axis];
    }
  }
  int directions = 0;
  AxisColumns solved = AxisColumns::Zero(kMostAxes, kMostAxes);
  if (!known.empty()) {
    const Eigen::JacobiSVD<AxisColumns> svd(
        readings, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto& values = svd.singularValues();
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      directions += values[i] > 0 && values[i] >= kLeastDirection * values[0];
    }
    solved = svd.solve(loads);
  }
  if (directions < static_cast<int>(kMostAxes)) {
    return InvalidConfig(
        "directions of the readings of known loads",
        absl::StrCat(directions, " in ", known.size(), " lines"),
        "3: press, and pull along x and along y");
  }
  CrossAxisFit fit;
  for (size_t i = 0; i < kMostAxes; ++i) {
    for (size_t j = 0; j < kMostAxes; ++j) {
      fit.cross_axis.rows[i][j] = solved(j, i);
    }
  }
  for (const KnownLoad& line : known) {
    const AxisVector load = fit.cross_axis.Load(line.reading);
    for (size_t axis = 0; axis < kMostAxes; ++axis) {
      fit.squares[axis] += std::pow(load[axis] - line.load[axis], 2);
    }
  }
  return fit;
}

}  // namespace tactus::internal::client
