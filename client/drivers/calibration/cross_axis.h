// File: cross_axis.h
//
// CrossAxis: the 3 x 3 matrix that makes a taxel's load along x, y and z of its
// readings, each of which answers to all three, and its fit to known loads.
//
//   TACTUS_ASSIGN_OR_RETURN(const CrossAxisFit fit, FitCrossAxis(known));
//   const AxisVector newton = fit.cross_axis.Load({12, -40, 800});
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

inline constexpr size_t kMostAxes = 3;
inline constexpr absl::string_view kAxisNames[] = {"x", "y", "z"};

// Numbers along x, y and z. Of a skin of one axis only the first counts, and
// the others are 0.
using AxisVector = std::array<double, kMostAxes>;

struct CrossAxis {
  // Loads, in the layout's unit, per reading: row i makes the load along axis
  // i.
  std::array<AxisVector, kMostAxes> rows = {};

  AxisVector Load(const AxisVector& reading) const {
    AxisVector load;
    for (size_t i = 0; i < kMostAxes; ++i) {
      load[i] = rows[i][0] * reading[0] + rows[i][1] * reading[1] +
                rows[i][2] * reading[2];
    }
    return load;
  }
  bool operator==(const CrossAxis&) const = default;
};

// The matrices of a skin: none, one for all taxels, or one per taxel, nothing
// for taxels that do not count.
using CrossAxes = std::vector<std::optional<CrossAxis>>;

// The matrix of a taxel; null if it has none.
inline const CrossAxis* MatrixOf(const CrossAxes& matrices, size_t taxel) {
  if (matrices.empty()) return nullptr;
  const auto& matrix = matrices.size() == 1 ? matrices[0] : matrices[taxel];
  return matrix ? &*matrix : nullptr;
}

// OK if there are as many matrices as CrossAxes says, and all numbers are
// finite and at most limits::kMaxTaxelValue; else INVALID_CONFIG.
absl::Status CheckMatrices(const CrossAxes& matrices, size_t taxels);

struct KnownLoad {
  // Above the taxel's baseline, in the numbers that the skin sends.
  AxisVector reading = {};
  // In the layout's unit.
  AxisVector load = {};
};

struct CrossAxisFit {
  CrossAxis cross_axis;
  // Sums over the known loads of the squared errors along each axis.
  AxisVector squares = {};
};

// The matrix whose loads have the least sum of squared errors. INVALID_CONFIG
// if a number is not finite or above limits::kMaxTaxelValue, or if the readings
// do not span three directions: the third singular value of their matrix is
// below a thousandth of the first.
absl::StatusOr<CrossAxisFit> FitCrossAxis(std::span<const KnownLoad> known);

}  // namespace tactus::internal::client
