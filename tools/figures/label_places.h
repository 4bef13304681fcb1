// File: label_places.h
//
// Places for the labels of points, so that labels cover neither each other nor
// the points.
//
//   const std::vector<LabelPlace> places =
//       PlaceLabels(labelled, occupied, plot_area, kSmallSize);
//   script.Text(labelled[0].label, places[0].at(), {.size = kSmallSize});
//
// Each label in turn takes the cheapest of some places beside, above and below
// its point, for a few rounds. Near places are cheap; places that cover
// something, whose leader does, or that leave the plot area are dear. Free
// functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/figures/gnuplot_script.h"

namespace tactus::internal::client {

struct LabelledPoint {
  // Pixels.
  Point at;
  std::string label;
};

struct Segment {
  Point from;
  Point to;
};

struct LabelPlace {
  Box box;
  // Joins a label with its point if the two are apart.
  std::optional<Segment> leader;

  // Where GnuplotScript::Text starts the label.
  Point at() const { return {box.left, (box.top + box.bottom) / 2}; }
};

// One place per point, in their order. `occupied` holds what labels must not
// cover: markers, lines. `size` is the height of the letters.
std::vector<LabelPlace> PlaceLabels(const std::vector<LabelledPoint>& points,
                                    const std::vector<Box>& occupied,
                                    const Box& area, double size);

// Pixels that both boxes cover.
double Overlap(const Box& a, const Box& b);

}  // namespace tactus::internal::client
