#include "tools/figures/label_places.h"

#include <algorithm>
#include <limits>

namespace tactus::internal::client {
namespace {

// From the centre of a marker to where its label or its leader may begin.
constexpr double kGap = 20;
constexpr double kLeaderGap = 14;
constexpr double kSpace = 5;
// A covered pixel counts as much as this many pixels of the label's own size.
constexpr double kCoverCost = 4;
// A pixel beyond the area, which may be cut off, costs more than any that the
// label could cover.
constexpr double kBeyondCost = 1000;
constexpr double kDistanceCost = 0.06;
// Rows of labels above and below the point that are tried.
constexpr int kFurthest = 8;
constexpr int kRounds = 4;

struct Candidate {
  LabelPlace place;
  double distance = 0;
};

Segment LeaderTo(const Box& box, Point point) {
  const bool below = box.top > point.y;
  return {{point.x, point.y + (below ? kLeaderGap : -kLeaderGap)},
          {std::clamp(point.x, box.left + 6, box.right - 6),
           below ? box.top : box.bottom}};
}

std::vector<Candidate> CandidatesAround(Point point, double width,
                                        double size) {
  const double half = 0.6 * size;
  std::vector<Candidate> candidates;
  // `side` is 1 to the right of the point, -1 to the left, 0 centred.
  const auto add = [&](int side, double shift, double distance) {
    double left = point.x - width / 2;
    if (side > 0) left = point.x + kGap;
    if (side < 0) left = point.x - kGap - width;
    const double middle = point.y + shift;
    LabelPlace place = {{left, middle - half, left + width, middle + half}, {}};
    if (distance > 1.5) place.leader = LeaderTo(place.box, point);
    candidates.push_back({place, distance});
  };
  add(1, 0, 0);
  add(-1, 0, 0.2);
  for (int row = 1; row <= kFurthest; ++row) {
    const double beyond = (row - 1) * (2 * half + 3);
    for (const int up : {-1, 1}) {
      add(0, up * (kGap + half + beyond), row);
      for (const int side : {1, -1}) {
        add(side, up * (half + 4 + beyond), row + 0.3);
      }
    }
  }
  return candidates;
}

// Boxes along the leader, which other labels should leave free.
std::vector<Box> BoxesAlong(const Segment& leader) {
  constexpr int kBoxes = 8;
  constexpr double kHalf = 4;
  std::vector<Box> boxes;
  for (int i = 0; i < kBoxes; ++i) {
    const double part = (i + 0.5) / kBoxes;
    const Point at = {leader.from.x + part * (leader.to.x - leader.from.x),
                      leader.from.y + part * (leader.to.y - leader.from.y)};
    boxes.push_back({at.x - kHalf, at.y - kHalf, at.x + kHalf, at.y + kHalf});
  }
  return boxes;
}

// What a label at `place` covers, with the space before and after its text.
std::vector<Box> Covered(const LabelPlace& place) {
  std::vector<Box> boxes;
  if (place.leader) boxes = BoxesAlong(*place.leader);
  const Box& box = place.box;
  boxes.push_back({box.left - kSpace, box.top, box.right + kSpace, box.bottom});
  return boxes;
}

double Cost(const Candidate& candidate, const std::vector<Box>& occupied,
            const Box& area) {
  const Box& box = candidate.place.box;
  const double pixels = box.width() * box.height();
  double cost = pixels * kDistanceCost * candidate.distance;
  // However little is covered, a free place is better.
  const auto add = [&](double covered) {
    if (covered > 0) cost += pixels + kCoverCost * covered;
  };
  const double beyond = pixels - Overlap(box, area) - 1e-6 * pixels;
  if (beyond > 0) cost += kBeyondCost * beyond;
  for (const Box& part : Covered(candidate.place)) {
    for (const Box& other : occupied) add(Overlap(part, other));
  }
  return cost;
}

}  // namespace

double Overlap(const Box& a, const Box& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0;
}

std::vector<LabelPlace> PlaceLabels(const std::vector<LabelledPoint>& points,
                                    const std::vector<Box>& occupied,
                                    const Box& area, double size) {
  std::vector<std::optional<LabelPlace>> places(points.size());
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 0; i < points.size(); ++i) {
      std::vector<Box> taken = occupied;
      for (size_t j = 0; j < points.size(); ++j) {
        if (j == i || !places[j]) continue;
        const std::vector<Box> others = Covered(*places[j]);
        taken.insert(taken.end(), others.begin(), others.end());
      }
      double least = std::numeric_limits<double>::infinity();
      const double width = TextWidth(points[i].label, size);
      for (const Candidate& candidate :
           CandidatesAround(points[i].at, width, size)) {
        const double cost = Cost(candidate, taken, area);
        if (cost >= least) continue;
        least = cost;
        places[i] = candidate.place;
      }
    }
  }
  std::vector<LabelPlace> chosen;
  for (const auto& place : places) chosen.push_back(*place);
  return chosen;
}

}  // namespace tactus::internal::client
