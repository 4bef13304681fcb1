// File: skin_patch.h
//
// SkinPatch: which boards and triangles of an iCub make up one skin, and to
// which cell of a layout each value belongs.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto boards,
//                           icub::ParseBoards("13,12:0-1+3+6+8-9+12-13"));
//   TACTUS_ASSIGN_OR_RETURN(const icub::SkinPatch patch,
//                           icub::PlacedPatch(boards, positions));
//
// Value 192 j + 12 t + k of a skin is dot k of triangle t of board j, j counted
// in the order of the list. Dots 6 and 10 of a triangle are thermal pads, which
// measure no touch. Plain data and functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/drivers/icub_skin/position_file.h"
#include "client/drivers/icub_skin/scan_assembler.h"
#include "core/skin/layout.h"

namespace tactus::internal::client::icub {

inline constexpr uint16_t kThermalDots = 1U << 6 | 1U << 10;

struct SkinPatch {
  std::vector<SkinBoard> boards;
  SkinLayout layout;
  // For each value its cell of the layout, row-major; -1: it is no taxel. A
  // cell of several values has the largest of them.
  std::vector<int> cells;
};

// "forearm-v1" and "forearm-v2" name the forearm of the iCub, 23 and 24
// triangles on boards 13 and 12. Otherwise a list of boards in the order of the
// port, each with its triangles if it has not all 16: "13,12:0-1+3". Addresses
// are 1 to 14, each at most once.
absl::StatusOr<std::vector<SkinBoard>> ParseBoards(absl::string_view text);

// A layout of one triangle per row and one dot per column, for skins whose
// positions are not known; thermal pads and missing triangles are masked. At
// most four boards.
absl::StatusOr<SkinPatch> PortPatch(const std::vector<SkinBoard>& boards);

// The taxels on a grid according to their positions (core/skin/taxel_grid.h);
// a curved patch is laid flat before (unroll.h). Masked are cells without a
// taxel. Taxels of one place share a cell: public files give many taxels the
// place of their triangle. If the places fit on no grid that keeps them apart,
// they are rounded to one whose pitch is the usual distance of neighbours. No
// taxels are `thermal_dots` of a triangle, values that the file calls none, and
// those of triangles that no board has. Palms and fingertips have no thermal
// dots.
absl::StatusOr<SkinPatch> PlacedPatch(const std::vector<SkinBoard>& boards,
                                      const TaxelPositions& positions,
                                      uint16_t thermal_dots = kThermalDots);

// Where the cells of a patch lie on the link, in metres: for each cell of the
// layout, the mean position of the values in it; nothing for a cell without a
// taxel. `positions` is that of PlacedPatch.
std::vector<std::optional<Eigen::Vector3d>> CellPositions(
    const SkinPatch& patch, const TaxelPositions& positions);

// OK if boards, layout and cells fit each other: every value has an entry,
// which is a cell or -1.
absl::Status Validate(const SkinPatch& patch);

}  // namespace tactus::internal::client::icub
