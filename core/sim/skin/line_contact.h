// File: line_contact.h
//
// Presses the flat, square face of an object against a skin with a compliant
// cover, and shares the force among the taxels. On a cylinder the face touches
// along a line that widens with the force.
//
//   LineContact contact(layout, {.row = 7.5, .column = 3});
//   contact.Press(2.5, {.edge_m = 0.04, .bedding_n_m3 = 1e7});
//   const double newton = contact.taxels()[7 * layout.columns + 3];
//
// Cover and object are a bed of independent springs (Winkler foundation; K. L.
// Johnson, "Contact Mechanics", 1985, Section 4.3): the pressure at a point is
// proportional to its indentation d + y tan(tilt) - s^2 / (2 R), where s runs
// along the circumference and y along the axis, both from the middle of the
// face. d is such that the pressures make up the force. A taxel reads the
// pressure on its cell, one pitch by one pitch.
//
// The face ends at its edges, at the ends of the skin, and on a wrapped skin
// at a quarter of the circumference on either side; what is left carries the
// whole force. A skin that does not wrap is flat. Not thread-safe: one per
// thread; Press() allocates nothing.
#pragma once

#include <vector>

#include "core/sim/skin/dent_kernels.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus::internal {

struct PressedFace {
  // Edge of the square face, m, above 0.
  double edge_m = 0;
  // Pressure for each metre of indentation, N/m^3, above 0: Bedding().
  double bedding_n_m3 = 0;
  // Angle between face and cylinder's axis; rows of higher number are pressed
  // more. Between -pi/4 and pi/4.
  double tilt_rad = 0;

  bool operator==(const PressedFace&) const = default;
};

// The bedding of a cube of `youngs_modulus` (Pa) and `edge_m` behind a cover of
// bedding `cover_n_m3`: two springs in series.
double Bedding(double youngs_modulus, double edge_m, double cover_n_m3);

class LineContact {
 public:
  // `layout` must be valid and `centre`, the middle of the face, on the skin.
  LineContact(const SkinLayout& layout, const SkinPoint& centre);

  // Presses with `force` >= 0 N. To press as before takes no time.
  void Press(double force, const PressedFace& face);

  // N on each taxel, row-major. They sum to the force.
  const std::vector<double>& taxels() const { return taxels_; }
  // Largest indentation under the middle of the face, m: d above; may be
  // negative if a tilted face touches with one end only.
  double indentation_m() const { return indentation_; }

 private:
  // A column of taxels that the face touches, with its part of the face along
  // the circumference, from the face's middle, m.
  struct Column {
    int number = 0;
    double low = 0;
    double high = 0;
  };

  void CutStrips(double edge_m);
  // Sum over all strips of a dent, N, and its derivative by the depth.
  double Force(const dent_kernels::Dent& dent, double bedding, double* slope);
  // Finds the dent's depth.
  void Solve(double force, double bedding, dent_kernels::Dent& dent);
  // Finds the columns that the dent reaches.
  void FindColumns(const dent_kernels::Dent& dent);

  int rows_;
  int columns_;
  double row_pitch_;
  double column_pitch_;
  bool wraps_;
  double curvature_;  // 1 / (2 R); 0 on a flat skin
  SkinPoint centre_;
  // Ends of the face along the circumference, from its middle, m.
  double low_ = 0;
  double high_ = 0;
  double edge_ = 0;  // for which the strips were cut
  // Strips of the face across the axis, kStripsPerRow to each row of taxels
  // from first_row_ on: their middles and widths along the axis, m. Filled up
  // to whole vectors with strips of no width.
  int first_row_ = 0;
  size_t strips_ = 0;
  std::vector<double> places_;
  std::vector<double> widths_;
  // Volume of each strip, and area of each strip and touched column.
  std::vector<double> volumes_;
  std::vector<double> areas_;
  std::vector<double> column_volumes_;
  std::vector<Column> touched_;
  // What was pressed last.
  double force_ = 0;
  PressedFace face_;
  double indentation_ = 0;
  std::vector<double> taxels_;
};

}  // namespace tactus::internal
