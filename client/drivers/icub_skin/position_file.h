// File: position_file.h
//
// Position files of the iCub's skin: where each value of a port lies on its
// link.
//
//   TACTUS_ASSIGN_OR_RETURN(const icub::TaxelPositions positions,
//                           icub::ParsePositions(text));
//   if (positions.values[17].present) Use(positions.values[17].position);
//
// The text has words and lists; what follows `[calibration]` is one row per
// value, "x y z nx ny nz" in metres and link coordinates. A row of zeros has no
// taxel: its triangle is not there, or its dot is a thermal pad. Rows may end
// in more numbers, which are ignored, as are blank lines and what follows a #.
//
// Plain data and a function without state; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client::icub {

struct TaxelPosition {
  bool present = false;
  // Metres.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  // Outward, of unit length; zero if the file has none.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

struct TaxelPositions {
  // Empty if the file has none.
  std::string name;
  // In the order of the port.
  std::vector<TaxelPosition> values;
  // By value, the taxel that stands for it; -1 or -2 if the value is no taxel
  // or a thermal pad. Empty if the file has none; it may be longer than
  // `values`.
  std::vector<int> representatives;
};

// At most 14 boards of values. INVALID_CONFIG naming the line otherwise, and if
// no row has a taxel.
absl::StatusOr<TaxelPositions> ParsePositions(absl::string_view text);

}  // namespace tactus::internal::client::icub
