#include "tools/figures/pareto.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tactus::internal::client {

std::vector<int> ParetoFront(const std::vector<ScatterPoint>& points,
                             Better better_x, Better better_y) {
  const double sign_x = better_x == Better::kLow ? 1 : -1;
  const double sign_y = better_y == Better::kLow ? 1 : -1;
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  // Best x first; a point is on the front if its y beats all before it.
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    const double xa = sign_x * points[a].x;
    const double xb = sign_x * points[b].x;
    if (xa != xb) return xa < xb;
    return sign_y * points[a].y < sign_y * points[b].y;
  });
  std::vector<int> front;
  double best = std::numeric_limits<double>::infinity();
  for (int i : order) {
    const double y = sign_y * points[i].y;
    if (y >= best) continue;
    best = y;
    front.push_back(i);
  }
  if (better_x == Better::kHigh) std::reverse(front.begin(), front.end());
  return front;
}

}  // namespace tactus::internal::client
